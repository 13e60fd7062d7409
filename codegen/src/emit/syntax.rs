//! Short constructors of syntax trees for function bodies.
//!
//! Bodies are built as syntax trees directly, since parsing hundreds of small token streams would dominate the
//! run time.

use proc_macro2::{Ident, Literal, Span};
use syn::punctuated::Punctuated;
use syn::{Attribute, BinOp, Expr, Member, Pat, Path, Stmt, UnOp, token};

use crate::schedule::names::identifier;

/// Words that cannot name a value in Rust, in any edition.
const KEYWORDS: &[&str] = &[
    "Self", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue",
    "crate", "do", "dyn", "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if",
    "impl", "in", "let", "loop", "macro", "match", "mod", "move", "mut", "override", "priv", "pub",
    "ref", "return", "self", "static", "struct", "super", "trait", "true", "try", "type", "typeof",
    "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

/// Statics, functions and types of the emitted text, which a local must not shadow.
const STATICS: &[&str] = &[
    "lu_factor",
    "lu_solve",
    "None",
    "Some",
    "Ok",
    "Err",
    "INFO",
    "SPEC",
    "STATES",
    "INPUTS",
    "PARAMETERS",
    "OUTPUTS",
    "SIGNALS",
    "SIGNAL_INPUTS",
    "CONSTRAINT_ROWS",
    "REACTIONS",
    "CONTACTS",
];

/// An identifier, whatever the text is. Keywords and names used by the emitted text get an underscore at the
/// end, and so do names that would then collide with these: different names stay different.
pub(super) fn ident(name: &str) -> Ident {
    let mut name = identifier(name);
    let stem = name.trim_end_matches('_');
    if KEYWORDS.contains(&stem) || STATICS.contains(&stem) {
        name.push('_');
    }
    Ident::new(&name, Span::call_site())
}

/// An identifier of this crate.
pub(super) fn known(name: &'static str) -> Ident {
    Ident::new(name, Span::call_site())
}

/// The path of a local, a field's type or a function.
pub(super) fn path(name: &str) -> Path {
    Path::from(ident(name))
}

/// A name as an expression.
pub(super) fn name(name: &str) -> Expr {
    path_expression(path(name))
}

fn path_expression(path: Path) -> Expr {
    Expr::Path(syn::ExprPath {
        attrs: Vec::new(),
        qself: None,
        path,
    })
}

/// `T::function(arguments)`
pub(super) fn associated(function: &'static str, arguments: Vec<Expr>) -> Expr {
    associated_with("T", function, arguments)
}

/// `Type::function(arguments)`
pub(super) fn associated_with(
    type_name: &'static str,
    function: &'static str,
    arguments: Vec<Expr>,
) -> Expr {
    let mut function_path = Path::from(known(type_name));
    function_path.segments.push(known(function).into());
    called(path_expression(function_path), arguments)
}

/// `function(arguments)`
pub(super) fn call(function: &'static str, arguments: Vec<Expr>) -> Expr {
    called(path_expression(Path::from(known(function))), arguments)
}

fn called(function: Expr, arguments: Vec<Expr>) -> Expr {
    Expr::Call(syn::ExprCall {
        attrs: Vec::new(),
        func: Box::new(function),
        paren_token: token::Paren::default(),
        args: arguments.into_iter().collect(),
    })
}

/// `receiver.method(arguments)`
pub(super) fn method(receiver: Expr, method: &'static str, arguments: Vec<Expr>) -> Expr {
    Expr::MethodCall(syn::ExprMethodCall {
        attrs: Vec::new(),
        receiver: Box::new(receiver),
        dot_token: token::Dot::default(),
        method: known(method),
        turbofish: None,
        paren_token: token::Paren::default(),
        args: arguments.into_iter().collect(),
    })
}

/// `left operator right`; the printer adds the parentheses.
pub(super) fn binary(left: Expr, op: BinOp, right: Expr) -> Expr {
    Expr::Binary(syn::ExprBinary {
        attrs: Vec::new(),
        left: Box::new(left),
        op,
        right: Box::new(right),
    })
}

/// `-inner`
pub(super) fn negated(inner: Expr) -> Expr {
    let op = UnOp::Neg(token::Minus::default());
    Expr::Unary(syn::ExprUnary {
        attrs: Vec::new(),
        op,
        expr: Box::new(inner),
    })
}

/// `&inner`
pub(super) fn borrowed(inner: Expr) -> Expr {
    Expr::Reference(syn::ExprReference {
        attrs: Vec::new(),
        and_token: token::And::default(),
        mutability: None,
        expr: Box::new(inner),
    })
}

/// `[elements]`
pub(super) fn array(elements: Vec<Expr>) -> Expr {
    Expr::Array(syn::ExprArray {
        attrs: Vec::new(),
        bracket_token: token::Bracket::default(),
        elems: elements.into_iter().collect(),
    })
}

/// A double as an exact literal, or a constant for non-finite values.
pub(super) fn number(value: f64) -> Expr {
    if value.is_nan() {
        return syn::parse_quote!(f64::NAN);
    }
    let literal = if value.is_infinite() {
        syn::parse_quote!(f64::INFINITY)
    } else {
        literal(Literal::f64_unsuffixed(value.abs()))
    };
    if value.is_sign_negative() {
        negated(literal)
    } else {
        literal
    }
}

/// `17` as an index or a length.
pub(super) fn index_number(value: usize) -> Expr {
    literal(Literal::usize_unsuffixed(value))
}

fn literal(literal: Literal) -> Expr {
    Expr::Lit(syn::ExprLit {
        attrs: Vec::new(),
        lit: syn::Lit::new(literal),
    })
}

/// `array[i][j]`
pub(super) fn entry(array: Expr, indices: &[usize]) -> Expr {
    indices.iter().fold(array, |array, &index| {
        Expr::Index(syn::ExprIndex {
            attrs: Vec::new(),
            expr: Box::new(array),
            bracket_token: token::Bracket::default(),
            index: Box::new(index_number(index)),
        })
    })
}

/// `value.field`
pub(super) fn field(value: Expr, name: &str) -> Expr {
    Expr::Field(syn::ExprField {
        attrs: Vec::new(),
        base: Box::new(value),
        dot_token: token::Dot::default(),
        member: Member::Named(ident(name)),
    })
}

/// `Type { field: value, …, ..rest }`, in shorthand form if field and value have the same name.
pub(super) fn structure(
    type_name: &'static str,
    fields: Vec<(&str, Expr)>,
    rest: Option<Expr>,
) -> Expr {
    let fields = fields.into_iter().map(|(field, value)| {
        let field = ident(field);
        let same = matches!(&value, Expr::Path(value) if value.path.is_ident(&field));
        syn::FieldValue {
            attrs: Vec::new(),
            member: Member::Named(field),
            colon_token: (!same).then(token::Colon::default),
            expr: value,
        }
    });
    Expr::Struct(syn::ExprStruct {
        attrs: Vec::new(),
        qself: None,
        path: Path::from(known(type_name)),
        brace_token: token::Brace::default(),
        fields: fields.collect(),
        dot2_token: rest.is_some().then(token::DotDot::default),
        rest: rest.map(Box::new),
    })
}

/// A name as a pattern.
pub(super) fn binding(name: &str) -> Pat {
    Pat::Ident(syn::PatIdent {
        attrs: Vec::new(),
        by_ref: None,
        mutability: None,
        ident: ident(name),
        subpat: None,
    })
}

/// `(a, b)`
pub(super) fn tuple_pattern(names: &[&str]) -> Pat {
    Pat::Tuple(syn::PatTuple {
        attrs: Vec::new(),
        paren_token: token::Paren::default(),
        elems: names.iter().map(|name| binding(name)).collect(),
    })
}

/// `[a, _, b]`
pub(super) fn array_pattern(names: &[Option<&str>]) -> Pat {
    let wild = || {
        Pat::Wild(syn::PatWild {
            attrs: Vec::new(),
            underscore_token: token::Underscore::default(),
        })
    };
    Pat::Slice(syn::PatSlice {
        attrs: Vec::new(),
        bracket_token: token::Bracket::default(),
        elems: names
            .iter()
            .map(|name| name.map_or_else(wild, binding))
            .collect(),
    })
}

/// `&Type { fields, .. }`, with the dots unless `all` fields are listed.
pub(super) fn borrowed_fields(type_name: &'static str, fields: &[&str], all: bool) -> Pat {
    let fields: Punctuated<syn::FieldPat, token::Comma> = fields
        .iter()
        .map(|name| syn::FieldPat {
            attrs: Vec::new(),
            member: Member::Named(ident(name)),
            colon_token: None,
            pat: Box::new(binding(name)),
        })
        .collect();
    let pattern = Pat::Struct(syn::PatStruct {
        attrs: Vec::new(),
        qself: None,
        path: Path::from(known(type_name)),
        brace_token: token::Brace::default(),
        fields,
        rest: (!all).then(|| syn::PatRest {
            attrs: Vec::new(),
            dot2_token: token::DotDot::default(),
        }),
    });
    Pat::Reference(syn::PatReference {
        attrs: Vec::new(),
        and_token: token::And::default(),
        mutability: None,
        pat: Box::new(pattern),
    })
}

/// `let pattern = value;`
pub(super) fn let_(attrs: Vec<Attribute>, pattern: Pat, value: Expr) -> Stmt {
    Stmt::Local(syn::Local {
        attrs,
        let_token: token::Let::default(),
        modifiers: syn::LocalModifiers::default(),
        pat: pattern,
        init: Some(syn::LocalInit {
            eq_token: token::Eq::default(),
            expr: Box::new(value),
            diverge: None,
        }),
        semi_token: token::Semi::default(),
    })
}
