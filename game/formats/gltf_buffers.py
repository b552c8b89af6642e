"""Buffers, buffer views and accessors of a glTF file, decoded to NumPy arrays.

Every extent is checked in whole numbers before a view is made: no array is larger than the bytes that are there,
or, for accessors that may lie outside any buffer, than a budget shared by the whole file.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from game.formats.gltf_container import Container, resolve_uri
from game.formats.gltf_shape import COMPONENTS, TYPES
from game.formats.json_shape import Report

__all__ = ["Buffers"]

Array = NDArray[Any]
_SPARE_BYTES = 16_000_000
_INTEGER_LIMITS = {"i1": 127.0, "u1": 255.0, "i2": 32767.0, "u2": 65535.0}


class Buffers:
    """The binary side of one document whose shape has been checked.

    Raises BadInput (JSON pointer) when made, where a buffer is missing or too short, a view leaves its buffer, or
    an accessor leaves its view.
    """

    def __init__(self, container: Container, report: Report, *, max_bytes: int) -> None:
        self._document = container.document
        self._report = report
        self._decoded: dict[int, Array] = {}
        self._buffers = self._load_buffers(container, max_bytes)
        # Honest files decode to a few times their size; overlapping or zero-filled accessors could go on for ever.
        self._allowed = self._budget = _SPARE_BYTES + 8 * sum(len(buffer) for buffer in self._buffers if buffer)
        for index in range(len(self._document.get("bufferViews", []))):
            self._check_view(index)
        for index in range(len(self._document.get("accessors", []))):
            self._check_accessor(index)

    def decode_all(self) -> None:
        """Decode every accessor whose data is there, so that faults in the data show at load."""
        for index, accessor in enumerate(self._document.get("accessors", [])):
            sparse = accessor.get("sparse", {})
            parts = (accessor, sparse.get("indices", {}), sparse.get("values", {}))
            views = [self._document["bufferViews"][part["bufferView"]] for part in parts if "bufferView" in part]
            if all(self._buffers[view["buffer"]] is not None for view in views):
                self.accessor(index)

    def view_bytes(self, index: int) -> bytes:
        """A copy of the bytes of a buffer view; none where its buffer has no data."""
        view = self._document["bufferViews"][index]
        start = view.get("byteOffset", 0)
        if self._buffers[view["buffer"]] is None:
            return b""
        return bytes(self._data(view["buffer"])[start : start + view["byteLength"]])

    def accessor(self, index: int) -> Array:
        """Decoded accessor, read-only: (count,) scalars, (count, n) vectors, (count, rows, columns) matrices.

        Normalised integers become float32 in [0, 1] or [-1, 1]; other component types stay as they are.
        Raises BadInput for NaN or infinity and for broken sparse data.
        """
        if index not in self._decoded:
            array = self._decode(index)
            array.setflags(write=False)
            self._decoded[index] = array
        return self._decoded[index]

    def _load_buffers(self, container: Container, max_bytes: int) -> list[memoryview | None]:
        buffers: list[memoryview | None] = []
        for index, buffer in enumerate(self._document.get("buffers", [])):
            pointer = ("buffers", index)
            if "uri" in buffer:
                where = self._report.where(*pointer, "uri")
                data = memoryview(resolve_uri(container.path, buffer["uri"], where, max_bytes=max_bytes, what="buffer"))
            elif index == 0 and container.is_glb:
                if container.binary is None:
                    self._report.refuse(pointer, "a buffer without data", hint="no uri and no BIN chunk")
                data = container.binary
            else:
                # Allowed while nothing reads it: some application knows where the data is.
                self._report.note(pointer, "a buffer without data")
                buffers.append(None)
                continue
            if len(data) < buffer["byteLength"]:
                self._report.refuse(
                    (*pointer, "byteLength"), expected=f"at most {len(data)}", seen=buffer["byteLength"]
                )
            max_bytes -= len(data)
            if max_bytes < 0:
                self._report.refuse(pointer, "buffers larger than this reader takes")
            buffers.append(data[: buffer["byteLength"]])
        return buffers

    def _data(self, buffer: int) -> memoryview:
        data = self._buffers[buffer]
        if data is None:
            self._report.refuse(("buffers", buffer), "a buffer without data is read")
        return data

    def _spend(self, size: int, pointer: tuple[str | int, ...]) -> None:
        self._budget -= size
        if self._budget < 0:
            self._report.refuse(pointer, f"more than {self._allowed} bytes of decoded data")

    def _check_view(self, index: int) -> None:
        view = self._document["bufferViews"][index]
        size = self._document["buffers"][view["buffer"]]["byteLength"]
        end = view.get("byteOffset", 0) + view["byteLength"]
        if end > size:
            self._report.refuse(("bufferViews", index), f"ends at byte {end} of a buffer of {size}")
        if view.get("byteStride", 0) > view["byteLength"]:
            self._report.refuse(
                ("bufferViews", index, "byteStride"), expected=f"at most {view['byteLength']}", seen=view["byteStride"]
            )

    def _check_accessor(self, index: int) -> None:
        accessor, pointer = self._document["accessors"][index], ("accessors", index)
        code = accessor["componentType"]
        if code not in COMPONENTS:
            self._report.refuse((*pointer, "componentType"), expected=" | ".join(map(str, COMPONENTS)), seen=code)
        if accessor.get("normalized") and code in (5125, 5126):
            self._report.refuse((*pointer, "normalized"), expected="8 or 16 bit integers", seen=COMPONENTS[code])
        columns, rows = TYPES[accessor["type"]]
        for bound in ("min", "max"):
            if bound in accessor and len(accessor[bound]) != columns * rows:
                self._report.refuse((*pointer, bound), expected=f"{columns * rows} numbers", seen=len(accessor[bound]))
        if "bufferView" in accessor:
            self._extent(
                accessor["bufferView"],
                accessor.get("byteOffset", 0),
                accessor["count"],
                code,
                accessor["type"],
                pointer,
            )
        elif "byteOffset" in accessor:
            self._report.refuse((*pointer, "byteOffset"), "given without a bufferView")
        if "sparse" in accessor:
            sparse, at = accessor["sparse"], (*pointer, "sparse")
            if sparse["count"] > accessor["count"]:
                self._report.refuse((*at, "count"), expected=f"at most {accessor['count']}", seen=sparse["count"])
            indices, values = sparse["indices"], sparse["values"]
            if indices["componentType"] not in (5121, 5123, 5125):
                self._report.refuse(
                    (*at, "indices", "componentType"), expected="5121 | 5123 | 5125", seen=indices["componentType"]
                )
            offset = indices.get("byteOffset", 0)
            self._extent(
                indices["bufferView"], offset, sparse["count"], indices["componentType"], "SCALAR", (*at, "indices")
            )
            offset = values.get("byteOffset", 0)
            self._extent(values["bufferView"], offset, sparse["count"], code, accessor["type"], (*at, "values"))

    def _extent(
        self, view_index: int, offset: int, count: int, code: int, kind: str, pointer: tuple[str | int, ...]
    ) -> None:
        view = self._document["bufferViews"][view_index]
        element, column = _layout(code, kind)
        stride = view.get("byteStride", element)
        if stride < element:
            self._report.refuse(pointer, f"elements of {element} bytes in a view with byteStride {stride}")
        # The last column needs no padding behind it.
        columns, rows = TYPES[kind]
        end = offset + stride * (count - 1) + column * (columns - 1) + rows * np.dtype(COMPONENTS[code]).itemsize
        if end > view["byteLength"]:
            self._report.refuse(pointer, f"needs {end} bytes of a view of {view['byteLength']}")
        size = np.dtype(COMPONENTS[code]).itemsize
        if (view.get("byteOffset", 0) + offset) % size or stride % size:
            self._report.note(pointer, f"data not aligned to {size} bytes")

    def _strided(self, view_index: int, offset: int, count: int, code: int, kind: str) -> Array:
        """A view (count, rows, columns) into the buffer."""
        view = self._document["bufferViews"][view_index]
        element, column = _layout(code, kind)
        columns, rows = TYPES[kind]
        dtype = np.dtype(COMPONENTS[code])
        return np.ndarray(
            (count, rows, columns),
            dtype,
            self._data(view["buffer"]),
            view.get("byteOffset", 0) + offset,
            (view.get("byteStride", element), dtype.itemsize, column),
        )

    def _decode(self, index: int) -> Array:
        accessor, pointer = self._document["accessors"][index], ("accessors", index)
        code, kind, count = accessor["componentType"], accessor["type"], accessor["count"]
        columns, rows = TYPES[kind]
        dtype = np.dtype(COMPONENTS[code])
        self._spend(count * columns * rows * max(dtype.itemsize, 4), pointer)
        if "bufferView" in accessor:
            data = self._strided(accessor["bufferView"], accessor.get("byteOffset", 0), count, code, kind).copy()
        else:
            data = np.zeros((count, rows, columns), dtype)
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            indices, values = sparse["indices"], sparse["values"]
            places = self._strided(
                indices["bufferView"], indices.get("byteOffset", 0), sparse["count"], indices["componentType"], "SCALAR"
            ).reshape(-1)
            if places[-1] >= count or np.any(places[1:] <= places[:-1]):
                self._report.refuse((*pointer, "sparse", "indices"), f"not increasing below the count {count}")
            data[places] = self._strided(values["bufferView"], values.get("byteOffset", 0), sparse["count"], code, kind)
        if "bufferView" in accessor or "sparse" in accessor:
            self._check_bounds(accessor, data, pointer)
        if accessor.get("normalized"):
            limit = np.float32(_INTEGER_LIMITS[dtype.str[1:]])
            data = np.maximum(data.astype(np.float32) / limit, np.float32(-1.0))
        elif dtype.kind == "f" and not np.isfinite(data).all():
            self._report.refuse(
                pointer, "holds NaN or infinity", hint=f"element {int(np.argwhere(~np.isfinite(data))[0][0])}"
            )
        if kind == "SCALAR":
            return data.reshape(count)
        return data.reshape(count, rows) if columns == 1 else data

    def _check_bounds(self, accessor: dict[str, Any], data: Array, pointer: tuple[str | int, ...]) -> None:
        # glTF stores matrices by columns; min and max follow that order.
        flat = data.transpose(0, 2, 1).reshape(len(data), -1)
        for bound, of in (("min", np.minimum), ("max", np.maximum)):
            if bound not in accessor:
                continue
            actual = of.reduce(flat, axis=0).astype(np.float64)
            # Mostly they are the same numbers: np.allclose takes as long as all the rest of an accessor.
            if actual.tolist() != accessor[bound] and not np.allclose(
                actual, np.array(accessor[bound], dtype=np.float64), rtol=1e-4, atol=1e-5, equal_nan=True
            ):
                self._report.note((*pointer, bound), "does not agree with the data")


def _layout(code: int, kind: str) -> tuple[int, int]:
    """Bytes of one element and from column to column; matrix columns start at multiples of 4 (section 3.6.2.4)."""
    columns, rows = TYPES[kind]
    column = np.dtype(COMPONENTS[code]).itemsize * rows
    if columns > 1:
        column = -(-column // 4) * 4
    return column * columns, column
