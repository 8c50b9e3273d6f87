"""What has to be known of an ONNX file before onnxruntime may open it.

An ONNX file can name other files on the disk as the place of its weights. onnxruntime would read
them, so a model from the internet could look at files that are none of its business. The file is
therefore searched for such names first. An ONNX file is a protocol buffer: a list of numbered
fields, of which some are messages that hold fields in turn. Only the fields on a way to a
tensor are opened.

References:
    ONNX, onnx/onnx.proto (the field numbers); Protocol Buffers, "Encoding" (the wire format).
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

_TENSOR, _SPARSE, _ATTRIBUTE, _NODE, _GRAPH, _FUNCTION, _TRAINING, _MODEL = range(8)

_HOLDS: Mapping[int, Mapping[int, int]] = MappingProxyType(
    {
        _MODEL: {7: _GRAPH, 20: _TRAINING, 25: _FUNCTION},
        _GRAPH: {1: _NODE, 5: _TENSOR, 15: _SPARSE},
        _TRAINING: {1: _GRAPH, 2: _GRAPH},
        _FUNCTION: {7: _NODE, 11: _ATTRIBUTE},
        _NODE: {5: _ATTRIBUTE},
        _ATTRIBUTE: {5: _TENSOR, 6: _GRAPH, 10: _TENSOR, 11: _GRAPH, 22: _SPARSE, 23: _SPARSE},
        _SPARSE: {1: _TENSOR, 2: _TENSOR},
        _TENSOR: {},
    }
)
"""For each kind of message, the numbers of the fields that can hold a tensor, and their kind."""

_EXTERNAL_DATA, _DATA_LOCATION = 13, 14


def names_other_files(content: bytes) -> bool:
    """Return whether any tensor of the ONNX model lies, or claims to lie, in another file.

    Args:
        content: The whole ONNX file.

    Raises:
        ValueError: The bytes are no protocol buffer.
    """
    waiting = [(_MODEL, memoryview(content))]
    while waiting:
        kind, message = waiting.pop()
        for number, value in _fields(message):
            if kind == _TENSOR and number in (_EXTERNAL_DATA, _DATA_LOCATION) and value:
                return True
            if isinstance(value, memoryview) and number in _HOLDS[kind]:
                waiting.append((_HOLDS[kind][number], value))
    return False


def _fields(message: memoryview) -> Iterator[tuple[int, memoryview | int]]:
    """Give the number and the value of each field; numbers of fixed width are skipped."""
    at = 0
    while at < len(message):
        key, at = _varint(message, at)
        length = 0
        match key & 7:
            case 0:
                value, at = _varint(message, at)
                yield key >> 3, value
            case 2:
                length, at = _varint(message, at)
                yield key >> 3, message[at : at + length]
            case 1:
                length = 8
            case 5:
                length = 4
            case unknown:
                raise ValueError(f"no protocol buffer: wire type {unknown}")
        at += length
        if at > len(message):
            raise ValueError("no protocol buffer: it ends within a field")


def _varint(message: memoryview, at: int) -> tuple[int, int]:
    """Return the number that begins at `at`, seven bits to a byte, and where it ends."""
    if at < len(message) and message[at] < 128:  # one byte, as most are: half the time of a search
        return message[at], at + 1
    number = 0
    for shift in range(0, 70, 7):
        if at >= len(message):
            raise ValueError("no protocol buffer: it ends within a number")
        byte = message[at]
        at += 1
        number |= (byte & 127) << shift
        if byte < 128:
            return number, at
    raise ValueError("no protocol buffer: a number of more than ten bytes")
