//! Compares encodings with another assembler.

#![allow(clippy::unwrap_used, reason = "a test may stop here")]

use super::*;

const KNOWN: &str = include_str!("known.txt");

/// General-purpose registers by their numbers.
const GENERAL: [&str; 16] = [
    "rax", "rcx", "rdx", "rbx", "rsp", "rbp", "rsi", "rdi", "r8", "r9", "r10", "r11", "r12", "r13",
    "r14", "r15",
];

fn general(text: &str) -> Option<General> {
    let number = GENERAL.iter().position(|&name| name == text)?;
    Some(General(u8::try_from(number).unwrap()))
}

/// Width and number of a vector register.
fn vector(text: &str) -> Option<(Width, u8)> {
    let (width, number) = match text.split_once("mm")? {
        ("z", number) => (Width::Zmm, number),
        ("y", number) => (Width::Ymm, number),
        _ => return None,
    };
    Some((width, number.parse().ok()?))
}

/// `qword ptr [base+distance]`
fn at(text: &str) -> Option<(General, i32)> {
    let (_, text) = text.split_once('[')?;
    let text = text.strip_suffix(']')?;
    let end = text.find(['+', '-']).unwrap_or(text.len());
    let distance = &text[end..];
    let distance = if distance.is_empty() { "0" } else { distance };
    Some((general(&text[..end])?, distance.parse().ok()?))
}

fn place(text: &str) -> Place {
    match (vector(text), at(text)) {
        (Some((_, number)), _) => Place::Vector(number),
        (_, Some((base, distance))) => Place::At(base, distance),
        _ => panic!("no place: {text}"),
    }
}

fn number(text: &str) -> u64 {
    match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16).unwrap(),
        None => text.parse().unwrap(),
    }
}

/// Encodes one instruction of the list.
fn write(code: &mut Code, text: &str) {
    let (name, operands) = text.split_once(' ').unwrap_or((text, ""));
    let operands: Vec<&str> = operands.split(", ").collect();
    match (name, &operands[..]) {
        ("vzeroupper", _) => code.clear_upper_halves(),
        ("leave", _) => code.leave(),
        ("ret", _) => code.end(),
        ("push", [register]) => code.push(general(register).unwrap()),
        ("pop", [register]) => code.pop(general(register).unwrap()),
        ("call", [register]) => code.call(general(register).unwrap()),
        ("movabs", [to, value]) => code.number(general(to).unwrap(), number(value)),
        ("lea", [to, from]) => {
            let (base, distance) = at(from).unwrap();
            code.address_of(general(to).unwrap(), base, distance);
        }
        ("mov", [to, from]) => match (general(to), general(from)) {
            (Some(to), Some(from)) => code.copy(to, from),
            (Some(to), None) => {
                let (base, distance) = at(from).unwrap();
                code.load(to, base, distance);
            }
            (None, from) => {
                let (base, distance) = at(to).unwrap();
                code.store(from.unwrap(), base, distance);
            }
        },
        ("vmovupd", [to, from]) => match (vector(to), vector(from)) {
            (Some((width, register)), _) => {
                let none = Options::default();
                code.vector(width, Opcode::LOAD, register, place(from), none);
            }
            (None, from) => {
                let (width, register) = from.unwrap();
                let none = Options::default();
                code.vector(width, Opcode::STORE, register, place(to), none);
            }
        },
        ("vsqrtpd" | "vbroadcastsd", [to, from]) => {
            let (width, register) = vector(to).unwrap();
            let opcode = match name {
                "vsqrtpd" => Opcode::SQRT,
                _ => Opcode::SPREAD,
            };
            code.vector(width, opcode, register, place(from), Options::default());
        }
        (_, [to, first, second, last @ ..]) => {
            let (to, mask) = match to.split_once("{k") {
                Some((to, mask)) => (to, mask.strip_suffix('}').unwrap().parse().unwrap()),
                None => (*to, 0),
            };
            let (width, first) = vector(first).unwrap();
            let immediate = last.first().map(|last| match vector(last) {
                Some((_, register)) => register << 4,
                None => u8::try_from(number(last)).unwrap(),
            });
            let opcode = match name {
                "vaddpd" => Opcode::ADD,
                "vsubpd" => Opcode::SUBTRACT,
                "vmulpd" => Opcode::MULTIPLY,
                "vdivpd" => Opcode::DIVIDE,
                "vandpd" => Opcode::AND,
                "vxorpd" => Opcode::XOR,
                "vcmppd" => Opcode::COMPARE,
                "vblendmpd" => Opcode::BLEND,
                "vblendvpd" => Opcode::BLEND_BY_SIGN,
                _ => panic!("{text}"),
            };
            let register = match vector(to) {
                Some((_, register)) => register,
                None => to.strip_prefix('k').unwrap().parse().unwrap(),
            };
            let options = Options {
                first,
                mask,
                immediate,
            };
            code.vector(width, opcode, register, place(second), options);
        }
        _ => panic!("{text}"),
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes
        .iter()
        .fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

#[test]
fn bytes_are_those_of_another_assembler() {
    for line in KNOWN.lines().filter(|line| !line.starts_with('#')) {
        let (expected, text) = line.split_once(' ').unwrap();
        let mut code = Code::default();
        write(&mut code, text.trim());
        assert_eq!(hexadecimal(&code.bytes), expected, "{text}");
    }
}

/// `vaddpd`, `vcmppd` and `lea` with constants, by the GNU assembler.
#[test]
fn constants_stand_behind_the_code() {
    for (width, repeated, expected, end) in [
        (
            Width::Zmm,
            1,
            "62f1ed58580d36000000\
             62f1bd50c20d330000001e\
             4c8d0524000000c3",
            "000000000000f03f0000000000000040",
        ),
        (
            Width::Ymm,
            2,
            "c5ed580d38000000\
             c5bdc20d3f0000001e\
             4c8d0528000000c3",
            "000000000000f03f000000000000f03f00000000000000400000000000000040",
        ),
    ] {
        let mut code = Code::default();
        let options = |first, immediate| Options {
            first,
            mask: 0,
            immediate,
        };
        let first = if width == Width::Zmm { 24 } else { 8 };
        code.vector(width, Opcode::ADD, 1, Place::Constant(0), options(2, None));
        let compared = options(first, Some(0x1e));
        code.vector(width, Opcode::COMPARE, 1, Place::Constant(1), compared);
        code.address_of_constant(R8, 0);
        code.end();
        code.constants(&[1.0_f64.to_bits(), 2.0_f64.to_bits()], repeated);
        let bytes = hexadecimal(&code.bytes);
        let (code, constants) = bytes.split_at(128);
        assert_eq!(code.trim_end_matches("cc"), expected, "{width:?}");
        assert_eq!(constants, end);
    }
}
