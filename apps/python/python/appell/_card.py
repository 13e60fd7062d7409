"""The equations at many places on a graphics card; arrays of other libraries by DLPack, without a copy."""

from __future__ import annotations

import ctypes
import types
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from . import _appell

# Kinds of memory and of numbers in DLPack.
CPU, CUDA, FLOAT = 1, 2, 2
# The first argument of functions that have one before x, where it has no weights.
OWN = {"inverse_dynamics": "accelerations", "inverse_dynamics_jacobians": "accelerations"}


class _Tensor(ctypes.Structure):
    """`DLManagedTensor`: an array, and how its owner gets it back."""


_Deleter = ctypes.CFUNCTYPE(None, ctypes.POINTER(_Tensor))
_Tensor._fields_ = [
    ("data", ctypes.c_void_p),
    ("device_kind", ctypes.c_int32),
    ("device", ctypes.c_int32),
    ("dimensions", ctypes.c_int32),
    ("code", ctypes.c_uint8),
    ("bits", ctypes.c_uint8),
    ("lanes", ctypes.c_uint16),
    ("shape", ctypes.POINTER(ctypes.c_int64)),
    ("strides", ctypes.POINTER(ctypes.c_int64)),
    ("offset", ctypes.c_uint64),
    ("owner", ctypes.c_void_p),
    ("deleter", _Deleter),
]

_python = ctypes.pythonapi
_python.PyCapsule_New.restype = ctypes.py_object
_python.PyCapsule_New.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
_python.PyCapsule_GetPointer.restype = ctypes.c_void_p
_python.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
_python.PyCapsule_SetName.argtypes = [ctypes.py_object, ctypes.c_char_p]
_python.PyCapsule_IsValid.argtypes = [ctypes.c_void_p, ctypes.c_char_p]
_GIVEN, _TAKEN = b"dltensor", b"used_dltensor"

# What is lent to other libraries, by the addresses of the tensors, until they return it.
_lent: dict[int, tuple[Any, ...]] = {}


@_Deleter
def _returned(tensor: Any) -> None:
    _lent.pop(ctypes.addressof(tensor.contents), None)


@ctypes.CFUNCTYPE(None, ctypes.c_void_p)
def _dropped(capsule: int) -> None:
    """A capsule that nobody took."""
    if _python.PyCapsule_IsValid(capsule, _GIVEN):
        get = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)(("PyCapsule_GetPointer", _python))
        _lent.pop(get(capsule, _GIVEN), None)


class CardArray:
    """Numbers in the memory of a graphics card; `torch.from_dlpack`, `cupy.from_dlpack` and the like see them without a
    copy."""

    dtype = np.dtype(np.float64)

    def __init__(self, memory: Any, shape: Sequence[int]):
        self._memory = memory
        self.shape = tuple(shape)
        inner = [self.shape[0] * int(np.prod(self.shape[axis + 1 :])) for axis in range(1, len(self.shape))]
        self.strides = (1, *inner)
        """Entries from one to the next along each axis: places are next to each other."""

    def numpy(self) -> np.ndarray:
        """A copy for the processor."""
        values = self._memory.read()
        steps = [stride * values.itemsize for stride in self.strides]
        return np.lib.stride_tricks.as_strided(values, self.shape, steps).copy()

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.asarray(self.numpy(), dtype)

    def __dlpack_device__(self) -> tuple[int, int]:
        return CUDA, 0

    @property
    def __cuda_array_interface__(self) -> dict[str, Any]:
        steps = tuple(stride * self.dtype.itemsize for stride in self.strides)
        data = (self._memory.address, False)
        return {"shape": self.shape, "typestr": "<f8", "data": data, "strides": steps, "version": 3}

    def __dlpack__(self, *, stream: Any = None, dl_device: tuple[int, int] | None = None, **_: Any) -> Any:
        # Calls wait for the card, so that there is nothing to wait for in the stream.
        if dl_device is not None and dl_device[0] == CPU:
            return self.numpy().__dlpack__()
        count = len(self.shape)
        shape, strides = (ctypes.c_int64 * count)(*self.shape), (ctypes.c_int64 * count)(*self.strides)
        tensor = _Tensor(self._memory.address, CUDA, 0, count, FLOAT, 64, 1, shape, strides, 0, None, _returned)
        address = ctypes.addressof(tensor)
        _lent[address] = (tensor, shape, strides, self._memory)
        return _python.PyCapsule_New(address, _GIVEN, ctypes.cast(_dropped, ctypes.c_void_p))


class _Borrowed:
    """An array of another library in the memory of the card, until the end of a call."""

    def __init__(self, array: Any):
        # Kernels run in the default stream, which this array is to be ready for.
        self._capsule = array.__dlpack__(stream=1)
        self._tensor = _Tensor.from_address(_python.PyCapsule_GetPointer(self._capsule, _GIVEN))
        _python.PyCapsule_SetName(self._capsule, _TAKEN)
        tensor = self._tensor
        self.address = (tensor.data or 0) + tensor.offset
        self.shape = tuple(tensor.shape[: tensor.dimensions])
        dense = [int(np.prod(self.shape[axis + 1 :])) for axis in range(len(self.shape))]
        self.strides = tuple(tensor.strides[: tensor.dimensions]) if tensor.strides else tuple(dense)
        self.is_double = (tensor.code, tensor.bits, tensor.lanes) == (FLOAT, 64, 1)

    def __del__(self) -> None:
        tensor = getattr(self, "_tensor", None)
        if tensor is not None and tensor.deleter:
            tensor.deleter(ctypes.byref(tensor))


class OnCard:
    """Functions of a model at many places on a graphics card, such as `rates(x, u, p, t)`: `Model.on_card` makes it.

    x is (N, n), u is (N, m), p is (k,) or (N, k); results are arrays on the card, `CardArray`. Arrays of the processor are
    copied. Arrays on the card are not: they have the values of a quantity one after another, as `torch.empty((n, N)).T`.
    """

    def __init__(self, model: Any, functions: Sequence[str]):
        self._model = model
        self._native = _appell.OnCard(model, list(functions))
        self._functions = {name: (own, results) for name, own, results in self._native.functions()}

    @property
    def functions(self) -> list[str]:
        """Names of the functions."""
        return list(self._functions)

    def array(self, values: Any) -> CardArray:
        """A copy of an array of the processor, (N, n), on the card."""
        values = np.asarray(values, float)
        return CardArray(self._native.copy(_by_quantity(values)), values.shape)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._functions]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._functions:
            raise AttributeError(f"there is no function {name!r} on the card: name it in `on_card`")
        return partial(self._call, name)

    def _call(self, name: str, *given: Any, **named: Any) -> Any:
        own, results = self._functions[name]
        names = ["x", "u", "p", "t"] if own is None else [OWN.get(name, "weights"), "x", "u", "p", "t"]
        if len(given) > len(names) or set(named) - set(names[len(given) :]):
            raise TypeError(f"the arguments of {name} are {', '.join(names)}")
        values = dict(zip(names, given)) | named
        for needed in names[: -3]:
            if values.get(needed) is None:
                raise TypeError(f"{name} needs {needed}")
        x, u, p, t = (values.get(one) for one in ("x", "u", "p", "t"))
        model = self._model
        x = self._placed("x", x, len(model.states))
        count = x.shape[0]
        u = self._placed("u", np.zeros((count, len(model.inputs))) if u is None else u, len(model.inputs), count)
        p = self._placed("p", model.parameter_values() if p is None else p, len(model.parameters), count, True)
        extra = None if own is None else self._placed(names[0], values[names[0]], own, count)
        each = len(p.shape) == 2
        address = None if extra is None else extra.address
        found = self._native.call(name, count, float(t or 0.0), p.address, each, x.address, u.address, address)
        arrays = {}
        for (result, shape), memory in zip(results, found, strict=True):
            arrays[result] = CardArray(memory, (count, *shape))
        return types.SimpleNamespace(**arrays) if len(arrays) > 1 else next(iter(arrays.values()))

    def _placed(self, name: str, value: Any, width: int, count: int | None = None, one: bool = False) -> Any:
        """An array on the card: a borrowed one, or a copy."""
        device = value.__dlpack_device__() if hasattr(value, "__dlpack_device__") else (CPU, 0)
        is_there = device[0] == CUDA
        if is_there and device[1] != 0:
            raise ValueError(f"{name} is on card {device[1]}; kernels run on the first one, card 0")
        array = _Borrowed(value) if is_there else np.asarray(value, float)
        shape = array.shape
        rows = "N" if count is None else count
        fits = len(shape) == 2 and shape[1] == width and count in (None, shape[0])
        if not fits and not (one and shape == (width,)):
            wanted = f"({width},) or ({rows}, {width})" if one else f"({rows}, {width})"
            raise ValueError(f"{name} has the shape {shape}; it needs {wanted}")
        if is_there:
            if not array.is_double:
                raise ValueError(f"{name} on the card needs numbers of 64 bits")
            if 0 not in shape and array.strides[0] != 1 or len(shape) == 2 and width > 1 and array.strides[1] != shape[0]:
                raise ValueError(f"{name} on the card needs the values of each column one after another")
            return array
        memory = self._native.copy(_by_quantity(array))
        return types.SimpleNamespace(shape=shape, address=memory.address, memory=memory)


def _by_quantity(values: np.ndarray) -> np.ndarray:
    """The entries with those of the first axis, the places, next to each other."""
    return np.ascontiguousarray(np.moveaxis(values, 0, -1)).ravel()
