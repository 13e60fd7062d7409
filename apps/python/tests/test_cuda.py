"""CUDA sources: for the processor as C, and for graphics cards as PTX."""

import ctypes
import subprocess
from pathlib import Path

import numpy as np
import pytest

from conftest import places

NAMES = ["unicycle", "euc_3dof", "four_bar", "cart_pole"]
STRICT = ["-std=c99", "-O2", "-ffp-contract=off", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"]


def library(text, folder, name):
    """The source as a shared library for the processor."""
    source = folder / f"{name}.c"
    source.write_text(text)
    built = folder / f"{name}.so"
    subprocess.run(["cc", *STRICT, str(source), "-o", str(built), "-lm"], check=True)
    return ctypes.CDLL(str(built))


def of_places(array):
    """The values of each quantity one after another."""
    return np.ascontiguousarray(array.T)


def pointer(array):
    return array.ctypes.data_as(ctypes.c_void_p)


@pytest.mark.parametrize("name", NAMES)
def test_kernels_have_the_bits_of_the_model(model, tmp_path, name):
    m = model(name)
    x, u, p = places(m, 7)
    # Parameters of each place, then those of the first one for all.
    expected = [m.jacobians(x, u, p), m.jacobians(x, u, p[0])]
    code = library(m.cuda(), tmp_path, name)
    n, states, inputs = 7, len(m.states), len(m.inputs)
    arrays = [of_places(x), of_places(u)]
    for each, values, wanted in zip((1, 0), (of_places(p), p[0].copy()), expected, strict=True):
        rates, a, b = (np.empty(size) for size in (states * n, states * states * n, states * inputs * n))
        results = [rates, a] + [b] * (inputs > 0)
        kernel = getattr(code, f"{name}_jacobians_places")
        arguments = [pointer(values), ctypes.c_int(each), *map(pointer, arrays), *map(pointer, results)]
        kernel(ctypes.c_int(n), ctypes.c_double(0.0), *arguments)
        np.testing.assert_array_equal(rates.reshape(states, n).T, wanted.rates)
        np.testing.assert_array_equal(a.reshape(states, states, n).transpose(2, 0, 1), wanted.A)
        np.testing.assert_array_equal(b.reshape(states, inputs, n).transpose(2, 0, 1), wanted.B)


def test_many_motions_take_the_steps_of_runge_and_kutta(model, tmp_path):
    m = model("pendulum")
    x, u, p = places(m, 3)
    code = library(m.cuda(integrator=True), tmp_path, "pendulum")
    state, inputs, values = of_places(x), of_places(u), of_places(p)
    steps, dt = 50, 0.01
    arguments = [pointer(values), ctypes.c_int(1), pointer(state), pointer(inputs)]
    code.pendulum_motions(ctypes.c_int(3), ctypes.c_int(steps), ctypes.c_double(0.0), ctypes.c_double(dt), *arguments)
    for _ in range(steps):
        k1 = m.rates(x, u, p)
        k2 = m.rates(x + dt / 2 * k1, u, p)
        k3 = m.rates(x + dt / 2 * k2, u, p)
        k4 = m.rates(x + dt * k3, u, p)
        x = x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    np.testing.assert_allclose(state.T, x, rtol=1e-13)


@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("name", NAMES)
def test_kernels_compile_for_graphics_cards(model, name, single):
    text = ptx(model(name).cuda(single=single, integrator=True))
    for kernel in ("rates_places", "jacobians_places", "motions"):
        assert f".visible .entry {name}_{kernel}(" in text


def ptx(source, options=(b"--gpu-architecture=compute_80", b"--fmad=false")):
    """What NVRTC makes of a source, without a word."""
    nvrtc = compiler()
    program = ctypes.c_void_p()
    assert nvrtc.nvrtcCreateProgram(ctypes.byref(program), source.encode(), b"model.cu", 0, None, None) == 0
    failed = nvrtc.nvrtcCompileProgram(program, len(options), (ctypes.c_char_p * len(options))(*options))
    said = told(nvrtc.nvrtcGetProgramLogSize, nvrtc.nvrtcGetProgramLog, program).strip()
    assert not failed and not said, said
    return told(nvrtc.nvrtcGetPTXSize, nvrtc.nvrtcGetPTX, program)


def compiler():
    """NVRTC of the package `nvidia-cuda-nvrtc-cu12`."""
    package = pytest.importorskip("nvidia.cuda_nvrtc")
    (folder,) = package.__path__
    (found,) = Path(folder).glob("lib/libnvrtc.so.*")
    return ctypes.CDLL(str(found))


def told(size, get, program):
    """A text of the compiler."""
    length = ctypes.c_size_t()
    size(program, ctypes.byref(length))
    text = ctypes.create_string_buffer(length.value)
    get(program, text)
    return text.value.decode()
