"""Settings as plain values: nested frozen dataclasses to dictionaries that JSON can hold, and back.

A member of a union carries the name of its class under `_type`. Unknown fields and wrong types
are refused, so that a file from another version never loads as something else.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

from cattrs import ClassValidationError, transform_error
from cattrs.preconf.json import JsonConverter, make_converter
from cattrs.strategies import configure_tagged_union

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
            raise InputError(f"{where}: {'; '.join(transform_error(error))}") from error

    @cached_property
    def _converter(self) -> JsonConverter:
        converter = make_converter(forbid_extra_keys=True)
        for union in self.unions:
            configure_tagged_union(union, converter)
            # At once: what holds this union takes the way to read it as it is then.
            if union in self.untagged:
                _tag_if_missing(converter, union, self.untagged[union])
        return converter


def _tag_if_missing(converter: JsonConverter, union: Any, member: type) -> None:  # noqa: ANN401
    """Let the converter read a member without a tag; one with an unknown tag stays refused."""
    tagged = converter.get_structure_hook(union)
    converter.register_structure_hook(
        union, lambda values, kind: tagged({"_type": member.__name__, **values}, kind)
    )
