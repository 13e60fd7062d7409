//! Bodies and their inertia.

use crate::ast::{ExprAst, ItemAst, ValueAst};
use crate::axis::Axis;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{BinaryOp, Expr, ExprKind};
use crate::ids::FrameId;
use crate::mechanism::{Body, Frame, GROUND, Inertia};
use crate::units::Dimension;

use super::dimensions::Dim;
use super::place::Place;
use super::resolver::Resolver;

const MASS: Place = Place::constant("the mass of a body");
const INERTIA: Place = Place::constant("a moment of inertia");

impl Resolver<'_> {
    pub(super) fn bodies(&mut self, frames: &[Frame]) -> Vec<Body> {
        let ast = self.ast;
        for (id, item) in ast.items("bodies").iter().enumerate() {
            self.bodies.insert(item.name.value.as_str(), id);
        }
        ast.items("bodies")
            .iter()
            .map(|item| self.body(item, frames))
            .collect()
    }

    fn body(&mut self, item: &ItemAst, frames: &[Frame]) -> Body {
        let frame = self.optional_reference(item, "frame");
        let inertia = match item.entry("inertia").map(|e| &e.value) {
            Some(ValueAst::Table(table)) => self.inertia(table),
            Some(ValueAst::Expression(moment)) => self.planar_inertia(moment, frame, frames),
            _ => None,
        };
        if let Some(inertia) = &inertia
            && item.entry("frame").is_none()
            && item.intact
        {
            let message = format!("`{}` has an inertia but no frame", item.name.value);
            let help = "name the frame that is fixed in the body";
            let finding = Diagnostic::error(Code::BodyWithoutFrame, message);
            self.tell(
                finding
                    .at(item.name.span.clone(), "`frame` is missing")
                    .at(inertia.span.clone(), "needs a frame fixed in the body")
                    .help(help),
            );
        }
        let mass = self.expression_of(item, "mass", &MASS, Dim::Known(Dimension::MASS));
        let taken_away = item.flag("taken_away");
        let signed = |expr| if taken_away { negative(expr) } else { expr };
        Body {
            name: item.name.value.clone(),
            about: Self::about(item),
            frame,
            centre: self.reference(item, "centre"),
            mass: signed(mass),
            inertia: inertia.map(|inertia| Inertia {
                matrix: inertia.matrix.map(|row| row.map(signed)),
                ..inertia
            }),
            taken_away,
            line: self.line(&item.name.span),
            span: item.name.span.clone(),
        }
    }

    /// The inertia of a body in planar motion from its moment about the normal: that of a lamina, as the other
    /// moments have no effect.
    fn planar_inertia(
        &mut self,
        moment: &ExprAst,
        frame: Option<FrameId>,
        frames: &[Frame],
    ) -> Option<Inertia> {
        let about_normal = self.expression(moment, &INERTIA, Dim::Known(Dimension::INERTIA));
        let span = moment.span.clone();
        let number = |value| Expr::integer(value, span.clone());
        let half = Expr {
            kind: ExprKind::Binary(
                BinaryOp::Divide,
                Box::new(about_normal.clone()),
                Box::new(number(2)),
            ),
            span: span.clone(),
        };
        // A missing frame is reported with the body.
        let normal = frame.map_or(Some(Axis::Z), |frame| normal(frame, frames));
        let Some(normal) = normal else {
            let message =
                "one moment of inertia is enough only for a body that turns about one axis";
            let help =
                "write `inertia = { in = \"FRAME\", diagonal = [\"I_x\", \"I_y\", \"I_z\"] }`";
            let finding = Diagnostic::error(Code::NotAllowedHere, message);
            self.tell(finding.at(span.clone(), "about which axis?").help(help));
            return None;
        };
        let matrix = [0, 1, 2].map(|i| {
            [0, 1, 2].map(|j| match (i == j, i == normal.index()) {
                (true, true) => about_normal.clone(),
                (true, false) => half.clone(),
                (false, _) => number(0),
            })
        });
        Some(Inertia {
            frame: frame.unwrap_or(GROUND),
            matrix,
            line: self.line(&span),
            span,
        })
    }

    fn inertia(&mut self, item: &ItemAst) -> Option<Inertia> {
        let wanted = Dim::Known(Dimension::INERTIA);
        let frame = self.reference(item, "in");
        let matrix = if let Some(ValueAst::Matrix(rows)) = item.entry("matrix").map(|e| &e.value) {
            let rows = rows
                .each_ref()
                .map(|row| row.each_ref().map(|e| self.expression(e, &INERTIA, wanted)));
            self.symmetric(&rows);
            rows
        } else {
            let zero = Expr::integer(0, item.name.span.clone());
            let key = if item.components("diagonal").is_some() {
                "diagonal"
            } else {
                "moments"
            };
            item.components(key)?;
            let [xx, yy, zz] = self.components_of(item, key, &INERTIA, wanted);
            let [xy, xz, yz] = if item.components("products").is_some() {
                self.components_of(item, "products", &INERTIA, wanted)
            } else {
                [zero.clone(), zero.clone(), zero]
            };
            [
                [xx, xy.clone(), xz.clone()],
                [xy, yy, yz.clone()],
                [xz, yz, zz],
            ]
        };
        Some(Inertia {
            frame,
            matrix,
            line: self.line(&item.name.span),
            span: item.name.span.clone(),
        })
    }

    /// Checks the symmetry of a tensor that is written with all entries.
    fn symmetric(&mut self, rows: &[[Expr; 3]; 3]) {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            if !same(&rows[i][j], &rows[j][i]) {
                let axes = Axis::LETTERS;
                let message = format!(
                    "the inertia is not symmetric: `I_{0}{1}` differs from `I_{1}{0}`",
                    axes[i], axes[j]
                );
                let help = "write both the same, or use `moments` with `products`";
                let finding = Diagnostic::error(Code::ConflictingKeys, message);
                self.tell(
                    finding
                        .at(rows[j][i].span.clone(), "this")
                        .at(rows[i][j].span.clone(), "and this")
                        .help(help),
                );
                return;
            }
        }
    }
}

/// The common axis of all rotations between a frame and the ground, if there is one.
fn normal(frame: FrameId, frames: &[Frame]) -> Option<Axis> {
    let mut normal = None;
    let mut at = Some(frame);
    while let Some(frame) = at {
        let frame = frames.get(frame.index())?;
        if frame.quaternion.is_some() {
            return None;
        }
        for turn in &frame.turns {
            if normal.is_some_and(|normal| normal != turn.axis) {
                return None;
            }
            normal = Some(turn.axis);
        }
        at = frame.parent;
    }
    normal
}

/// The negative of an expression, at the same position.
fn negative(expr: Expr) -> Expr {
    Expr {
        span: expr.span.clone(),
        kind: ExprKind::Negate(Box::new(expr)),
    }
}

/// Whether two expressions are syntactically equal.
fn same(a: &Expr, b: &Expr) -> bool {
    let is_alike = match (&a.kind, &b.kind) {
        (ExprKind::Number(x), ExprKind::Number(y)) => x == y,
        (ExprKind::Quantity(x), ExprKind::Quantity(y)) => x == y,
        (ExprKind::Negate(_), ExprKind::Negate(_)) => true,
        (ExprKind::Binary(p, ..), ExprKind::Binary(q, ..)) => p == q,
        (ExprKind::Call(f, _), ExprKind::Call(g, _)) => f == g,
        (ExprKind::Choice { relation: r, .. }, ExprKind::Choice { relation: s, .. }) => r == s,
        _ => false,
    };
    let (own, others) = (a.parts(), b.parts());
    is_alike && own.len() == others.len() && own.iter().zip(others).all(|(a, b)| same(a, b))
}
