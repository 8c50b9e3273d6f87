"""Settings as plain values: nested frozen dataclasses to dictionaries that JSON can hold, and back.

A member of a union carries the name of its class under `_type`. Unknown fields and wrong types
are refused, so that a file from another version never loads as something else.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from functools import cached_property
from typing import Any, TypeVar, get_args

from cattrs import ClassValidationError, transform_error
from cattrs.errors import ForbiddenExtraKeysError
from cattrs.preconf.json import JsonConverter, make_converter
from cattrs.strategies import configure_tagged_union
from cattrs.v import format_exception

from flexdepth.runtime.errors import InputError

Settings = TypeVar("Settings")


@dataclass(frozen=True)
class Codec:
    """Translates the settings whose alternatives are the given unions.

    Attributes:
        unions: Every union of settings classes that occurs in what is translated.
        untagged: The member that is meant where a file has no `_type`, for those of the unions
            that once had but one member.
    """

    unions: tuple[Any, ...]
    untagged: Mapping[Any, type] = field(default_factory=dict)

    def plain(self, settings: object) -> dict[str, Any]:
        """Return the settings as nested dictionaries, lists, numbers and strings."""
        values: dict[str, Any] = self._converter.unstructure(settings)
        return values

    def restored(self, kind: type[Settings], values: object, where: str) -> Settings:
        """Return the settings that `plain` made the values from.

        Args:
            kind: The class of the settings.
            values: Nested plain values.
            where: What they were read from, for the message.

        Raises:
            InputError: A field is unknown, missing or of another type; all of them are named.
        """
        try:
            return self._converter.structure(values, kind)
        except ClassValidationError as error:
            said = transform_error(error, format_exception=_told)
            raise InputError(f"{where}: {'; '.join(map(_place_first, said))}") from error

    @cached_property
    def _converter(self) -> JsonConverter:
        converter = make_converter(forbid_extra_keys=True)
        for union in self.unions:
            configure_tagged_union(union, converter)
            # At once: what holds this union takes the way to read it as it is then.
            _check_tags(converter, union, self.untagged.get(union))
        return converter


def _check_tags(converter: JsonConverter, union: Any, untagged: type | None) -> None:  # noqa: ANN401
    """Let the converter say which members a union has, and read one without a tag if it may be."""
    tagged = converter.get_structure_hook(union)
    members = sorted(member.__name__ for member in get_args(union))

    def structured(values: object, kind: Any) -> object:  # noqa: ANN401
        if not isinstance(values, Mapping):
            raise InputError(f"wanted fields and a `_type` of {members}, got {values!r}")
        name = values.get("_type", untagged.__name__ if untagged else None)
        if name not in members:
            raise InputError(f"no `_type` {name!r}; choose one of {members}")
        return tagged({**values, "_type": name}, kind)

    converter.register_structure_hook(union, structured)


def _told(error: BaseException, kind: type | None) -> str:
    if isinstance(error, InputError):
        return str(error)
    if isinstance(error, ForbiddenExtraKeysError):
        unknown, known = sorted(error.extra_fields), [each.name for each in fields(error.cl)]
        near = get_close_matches(unknown[0], known, n=1)
        hint = f"did you mean {near[0]!r}?" if near else f"it has {known}"
        named = ", ".join(map(repr, unknown))
        return f"{error.cl.__name__} has no field {named}; {hint}"
    return format_exception(error, kind)


def _place_first(message: str) -> str:
    """Return `terms.sky: ...` of the `... @ $.terms.sky` that cattrs says."""
    said, _, place = message.rpartition(" @ $")
    return f"{place.removeprefix('.')}: {said}" if place else said
