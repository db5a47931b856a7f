"""Arrays in the memory of the device, which kernels take as arguments."""

from typing import TYPE_CHECKING, Any

import numpy as np

from vitruvius.sim.huge_pages import ask_for_huge_pages
from vitruvius.sim.runtime.forks import compiling
from vitruvius.sim.runtime.process import on_gpu
from vitruvius.sim.tracing import compiler, ti

if TYPE_CHECKING:
    import torch

Bytes, Shorts, Words = (ti.types.ndarray(kind, 1) for kind in (ti.u8, ti.u16, ti.u64))
Ints, Longs, Floats = (ti.types.ndarray(kind, 1) for kind in (ti.i32, ti.i64, ti.f32))
"""Annotations of a kernel's arrays of numbers."""


TYPES = {
    np.float32: ti.f32,
    np.int32: ti.i32,
    np.int64: ti.i64,
    np.int16: ti.i16,
    np.uint8: ti.u8,
    np.uint16: ti.u16,
    np.uint64: ti.u64,
}
_NUMPY = {theirs: ours for ours, theirs in TYPES.items()}


def element(dtype: Any, width: int = 1) -> Any:
    """Return the compiler's type of an array's elements: numbers, or vectors if the width is over 1."""
    return dtype if width == 1 else ti.types.vector(width, dtype)


class Array:
    """Numbers or short vectors in contiguous memory of the device, initially zero.

    Kernels take ``.ndarray``. On the CPU, ``view()`` returns the same memory as a NumPy array.
    """

    def __init__(self, dtype: Any, length: int, width: int = 1) -> None:
        """Allocate ``length`` elements: numbers, or vectors if ``width`` is more than one."""
        self.shape = (length,) if width == 1 else (length, width)
        self.dtype: type = _NUMPY[dtype]
        # Taichi has no empty arrays.
        allotted = max(1, length)
        with compiling:
            self.ndarray = ti.ndarray(element(dtype, width), allotted)
        self.on_gpu = on_gpu()  # computed once, because each step copies several arrays
        self._view: np.ndarray | None = None
        if not self.on_gpu:
            ask_for_huge_pages(self.view())

    @classmethod
    def of(cls, values: np.ndarray) -> "Array":
        """Return an array that contains ``values`` (n,)."""
        array = cls(TYPES[values.dtype.type], len(values))
        array.fill(values)
        return array

    def fill(self, values: np.ndarray) -> None:
        """Copy ``values`` into the array: (length,), or (length, width)."""
        if not self.on_gpu:
            self.view()[:] = values
        elif self.shape[0]:
            self.ndarray.from_numpy(np.ascontiguousarray(values))

    def numpy(self) -> np.ndarray:
        """Return a copy of the contents: (length,), or (length, width)."""
        if self._view is not None:
            return self._view.copy()
        if self.on_gpu:
            return self.ndarray.to_numpy()[: self.shape[0]]
        return self.view().copy()

    def view(self) -> np.ndarray:
        """Return the array's memory as a NumPy array, which keeps the memory alive.

        Raises ``RuntimeError`` on a GPU.
        """
        if self._view is None:
            if self.on_gpu:
                raise RuntimeError("NumPy cannot read GPU memory: use numpy(), a copy, or tensor()")
            interface = self._interface(self.shape, self.dtype)
            self._view = np.asarray(_Memory(self.ndarray, {"__array_interface__": interface}))
        return self._view

    def tensor(self, dtype: type, shape: tuple[int, ...]) -> "torch.Tensor":
        """Return the memory as a tensor of this NumPy type and shape, which keeps the memory alive."""
        import torch

        if not self.on_gpu:
            return torch.from_numpy(self.view().view(dtype).reshape(shape))
        interface = self._interface(shape, dtype)
        return torch.as_tensor(_Memory(self.ndarray, {"__cuda_array_interface__": interface}), device="cuda")

    def _interface(self, shape: tuple[int, ...], dtype: type) -> dict[str, Any]:
        """Return the array interface of the memory, in the form that NumPy and CUDA define."""
        program: Any = compiler.program()
        pointer = program.get_ndarray_data_ptr_as_int(self.ndarray.arr)
        return {"data": (pointer, False), "shape": shape, "typestr": np.dtype(dtype).str, "version": 3}


class _Memory:
    """Object with the array interface that NumPy or torch reads.

    It keeps the memory alive as long as a view of it.
    """

    def __init__(self, owner: Any, interface: dict[str, Any]) -> None:
        self.owner = owner
        self.__dict__.update(interface)
