"""Numeric arrays of an NPZ archive, without pickles; every declared size is checked before anything is unpacked."""

import io
import lzma
import math
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Container
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.base.errors import InputError, quoted, reason_of

_MOST_MEMBERS = 200
DAMAGED = (
    zipfile.BadZipFile, zipfile.LargeZipFile, zlib.error, lzma.LZMAError, OSError, EOFError, NotImplementedError,
    RuntimeError, ValueError, SyntaxError, tokenize.TokenError, TypeError, OverflowError, IndexError, KeyError,
    AttributeError, struct.error,
)  # fmt: skip
"""All that the readers of archives and of NumPy's headers, which are Python text, were seen to raise for a damaged or
hostile file: whoever calls them turns these into a refusal that names the file."""

_HEADER_ALLOWANCE = 4096


def read_npz_arrays(
    data: bytes, file_name: str, most_bytes: int, kinds: str = "fiub", names: Container[str] | None = None
) -> dict[str, NDArray[Any]]:
    """Numeric arrays of an NPZ archive by name. Memory and time are bounded by `most_bytes`.

    Parameters
    ----------
    data : bytes
        The archive.
    file_name : str
        Name for messages.
    most_bytes : int
        Bytes of all arrays together, unpacked.
    kinds : str, optional
        NumPy's letters of the dtypes that are allowed.
    names : container of str, optional
        Arrays to read; all by default.

    Raises
    ------
    InputError
        For a broken archive, members that are not .npy arrays, object (pickle) or text dtypes, arrays whose header or
        directory entry declares more than `most_bytes` in total, and entries whose two sizes disagree.
    """
    arrays: dict[str, NDArray[Any]] = {}
    what = "not a readable NPZ archive"
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = [m for m in archive.infolist() if names is None or m.filename.removesuffix(".npy") in names]
            if len(members) > _MOST_MEMBERS:
                raise InputError(file_name, f"{len(members)} arrays; at most {_MOST_MEMBERS}")
            if (declared := sum(member.file_size for member in members)) > most_bytes:
                most = f"at most {most_bytes / 1e6:.0f} MB are allowed"
                raise InputError(file_name, f"unpacks to {declared / 1e6:.0f} MB; {most}")
            for member in members:
                name = member.filename.removesuffix(".npy")
                where = f"array {quoted(name)}"
                what = f"{where}: not a readable .npy array"
                if not member.filename.endswith(".npy") or member.flag_bits & 1:
                    raise InputError(file_name, f"{where}: not a plain .npy array")
                with archive.open(member) as handle:
                    shape, dtype = _header(handle)
                if dtype.kind not in kinds:
                    reason = f"holds {dtype}, not numbers; objects and text are never unpacked"
                    raise InputError(file_name, f"{where}: {reason}")
                if (size := math.prod(shape) * dtype.itemsize) > member.file_size:
                    reason = f"its header declares {size} bytes, the archive holds {member.file_size}"
                    raise InputError(file_name, f"{where}: {reason}")
                with archive.open(member) as handle:
                    arrays[name] = np.lib.format.read_array(handle, allow_pickle=False)
    except InputError:
        raise
    except DAMAGED as error:
        # Without the file's own lines, which an error of syntax quotes.
        reason = str(error.msg) if isinstance(error, SyntaxError) else reason_of(error)
        raise InputError(file_name, f"{what} ({reason})") from error
    return arrays


def _header(handle: Any) -> tuple[tuple[int, ...], np.dtype[Any]]:
    """Shape and type that the .npy header promises."""
    version = np.lib.format.read_magic(handle)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read(handle, max_header_size=_HEADER_ALLOWANCE)
    return shape, dtype
