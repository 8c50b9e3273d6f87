"""What stands in rooms, by where it stands."""

from flexdepth.synth.bystanders import bystander, sitter
from flexdepth.synth.fixtures import (
    bag,
    ball,
    bicycle,
    board,
    boiler,
    coats,
    drape,
    lamp,
    mirror,
    plant,
    radiator,
    television,
    toy_house,
    washing,
)
from flexdepth.synth.parts import Maker
from flexdepth.synth.seating import bed, chair, office_chair, slatted, sofa, stool
from flexdepth.synth.storage import boards, cabinet, crates, goods, heap, rack, shelf, stack
from flexdepth.synth.tables import desk, kitchen, table

FREE_STANDING: tuple[Maker, ...] = (
    table, table, table, chair, slatted, slatted, office_chair, stool, sofa, lamp, plant, stack,
    ball, bystander, sitter, toy_house, cabinet, heap, washing, bag, bag, bicycle,
)  # fmt: skip
"""What may stand anywhere in a room; twice what stands there often."""

AGAINST_WALLS: tuple[Maker, ...] = (
    shelf, shelf, sofa, bed, cabinet, cabinet, kitchen, desk, desk, table, drape, plant,
    coats, radiator, mirror, television, board,
)  # fmt: skip
"""What stands with its back (its +z side) to a wall."""

STORED: tuple[Maker, ...] = (
    heap, heap, heap, rack, rack, rack, stack, stack, boiler, washing, table, cabinet, ball,
    slatted, sofa, crates, crates, boards, boards, bicycle, bag, shelf, desk, drape,
)  # fmt: skip
"""What stands in cellars, sheds and workshops, along the walls as well as anywhere."""

OFFICES: tuple[Maker, ...] = (
    desk, desk, desk, desk, shelf, shelf, cabinet, table, board, board, plant, coats, radiator,
    rack,
)  # fmt: skip
"""What stands along the walls of offices."""

IN_OFFICES: tuple[Maker, ...] = (
    desk, desk, office_chair, office_chair, office_chair, table, stack, bag, plant, bystander,
    sitter, sitter, cabinet, stool,
)  # fmt: skip
"""What stands anywhere in offices."""

KITCHENS: tuple[Maker, ...] = (kitchen, kitchen, kitchen, kitchen, cabinet, shelf, table, radiator)
"""What stands along the walls of kitchens."""

SHOPS: tuple[Maker, ...] = (goods, goods, goods, goods, shelf, rack, kitchen, board)
"""What stands along the walls of shops."""

IN_SHOPS: tuple[Maker, ...] = (
    goods, goods, goods, table, stack, crates, bystander, bystander, bag, plant, rack, washing,
)  # fmt: skip
"""What stands anywhere in shops."""
