//! The instructions of both vector units.

use iced_x86::{Code, Register};

/// Registers and instructions of one width.
#[derive(Debug, Clone, Copy)]
pub(crate) struct InstructionSet {
    /// Numbers in a register.
    pub(crate) lanes: u8,
    /// The first register for values.
    pub(crate) first: Register,
    /// Number of registers for values.
    pub(crate) registers: u8,
    /// The register with the result of a comparison.
    pub(crate) mask: Register,
    /// Copies of each constant in memory: only wide instructions can broadcast a number to all lanes.
    pub(crate) copies: u8,
    pub(crate) load: Code,
    /// Loads a constant into all lanes.
    pub(crate) load_constant: Code,
    pub(crate) store: Code,
    pub(crate) square_root: Code,
    pub(crate) and: Code,
    pub(crate) xor: Code,
    pub(crate) add: Code,
    pub(crate) subtract: Code,
    pub(crate) multiply: Code,
    pub(crate) divide: Code,
    pub(crate) compare: Code,
    /// Selects by the mask.
    pub(crate) select: Code,
}

/// Four numbers.
pub(crate) const AVX: InstructionSet = InstructionSet {
    lanes: 4,
    first: Register::YMM0,
    registers: 15,
    mask: Register::YMM15,
    copies: 4,
    load: Code::VEX_Vmovupd_ymm_ymmm256,
    load_constant: Code::VEX_Vmovupd_ymm_ymmm256,
    store: Code::VEX_Vmovupd_ymmm256_ymm,
    square_root: Code::VEX_Vsqrtpd_ymm_ymmm256,
    and: Code::VEX_Vandpd_ymm_ymm_ymmm256,
    xor: Code::VEX_Vxorpd_ymm_ymm_ymmm256,
    add: Code::VEX_Vaddpd_ymm_ymm_ymmm256,
    subtract: Code::VEX_Vsubpd_ymm_ymm_ymmm256,
    multiply: Code::VEX_Vmulpd_ymm_ymm_ymmm256,
    divide: Code::VEX_Vdivpd_ymm_ymm_ymmm256,
    compare: Code::VEX_Vcmppd_ymm_ymm_ymmm256_imm8,
    select: Code::VEX_Vblendvpd_ymm_ymm_ymmm256_ymm,
};

/// Eight numbers.
pub(crate) const AVX512: InstructionSet = InstructionSet {
    lanes: 8,
    first: Register::ZMM0,
    registers: 32,
    mask: Register::K1,
    copies: 1,
    load: Code::EVEX_Vmovupd_zmm_k1z_zmmm512,
    load_constant: Code::EVEX_Vbroadcastsd_zmm_k1z_xmmm64,
    store: Code::EVEX_Vmovupd_zmmm512_k1z_zmm,
    square_root: Code::EVEX_Vsqrtpd_zmm_k1z_zmmm512b64_er,
    and: Code::EVEX_Vandpd_zmm_k1z_zmm_zmmm512b64,
    xor: Code::EVEX_Vxorpd_zmm_k1z_zmm_zmmm512b64,
    add: Code::EVEX_Vaddpd_zmm_k1z_zmm_zmmm512b64_er,
    subtract: Code::EVEX_Vsubpd_zmm_k1z_zmm_zmmm512b64_er,
    multiply: Code::EVEX_Vmulpd_zmm_k1z_zmm_zmmm512b64_er,
    divide: Code::EVEX_Vdivpd_zmm_k1z_zmm_zmmm512b64_er,
    compare: Code::EVEX_Vcmppd_kr_k1_zmm_zmmm512b64_imm8_sae,
    select: Code::EVEX_Vblendmpd_zmm_k1z_zmm_zmmm512b64,
};
