//! Sources to machine code of a card.
// The compiler is called by addresses, which its bindings do not check.
#![allow(unsafe_code)]

use std::ffi::{CStr, CString, c_char};

use cudarc::nvrtc::{Ptx, result, sys};

use crate::error::CardError;

/// A program of the compiler, destroyed at the end.
struct Program(sys::nvrtcProgram);

impl Drop for Program {
    fn drop(&mut self) {
        // SAFETY: the program was created and is destroyed once. Nothing can be done if that fails.
        let _ = unsafe { result::destroy_program(self.0) };
    }
}

/// Machine code for a card of this compute capability: drivers need not know the compiler's own language then, which is
/// newer than many. A compiler older than the card writes that language, which the driver translates.
pub(crate) fn compiled(source: &str, [major, minor]: [i32; 2]) -> Result<Ptx, CardError> {
    let refused = |error: result::NvrtcError| CardError::Compiler(error.to_string());
    let text = CString::new(source).map_err(|error| CardError::Compiler(error.to_string()))?;
    let mut said = String::new();
    for options in [vec![format!("-arch=sm_{major}{minor}")], Vec::new()] {
        let program = Program(result::create_program(&text, None).map_err(refused)?);
        // SAFETY: the program exists, and its source lives until it is destroyed.
        let compiled = unsafe { result::compile_program(program.0, &options) };
        match compiled {
            Ok(()) if options.is_empty() => {
                // SAFETY: the program is compiled.
                let ptx = unsafe { result::get_ptx(program.0) }.map_err(refused)?;
                return Ok(Ptx::from_src(text_of(&ptx)));
            }
            Ok(()) => return Ok(Ptx::from_binary(machine_code(&program)?)),
            Err(result::NvrtcError(sys::nvrtcResult::NVRTC_ERROR_INVALID_OPTION)) => {}
            Err(error) => {
                // SAFETY: the program exists.
                let log = unsafe { result::get_program_log(program.0) };
                said = log.map_or_else(|_| error.to_string(), |log| text_of(&log));
                break;
            }
        }
    }
    Err(CardError::Compiler(said.trim().to_owned()))
}

fn machine_code(program: &Program) -> Result<Vec<u8>, CardError> {
    let mut size = 0;
    // SAFETY: the program is compiled for a card; `size` outlives the call.
    let known = unsafe { sys::nvrtcGetCUBINSize(program.0, &raw mut size) };
    let mut code = vec![0_u8; size];
    // SAFETY: the code has this size.
    let mut read = || unsafe { sys::nvrtcGetCUBIN(program.0, code.as_mut_ptr().cast()) }.result();
    let done = known.result().and_then(|()| read());
    done.map_err(|error| CardError::Compiler(error.to_string()))?;
    Ok(code)
}

/// Characters up to the zero that ends them.
fn text_of(characters: &[c_char]) -> String {
    let bytes: Vec<u8> = characters.iter().map(|one| one.to_ne_bytes()[0]).collect();
    let text = CStr::from_bytes_until_nul(&bytes);
    text.map_or_else(
        |_| String::new(),
        |text| text.to_string_lossy().into_owned(),
    )
}
