import struct
import sys
import zlib
from io import BytesIO

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from PIL import Image, ImageCms, features

from flexdepth.runtime.errors import InputError
from flexdepth.runtime.images import is_picture_name, photos_in, read_photo

RED, GREEN, BLUE, WHITE, BLACK = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255,) * 3, (0,) * 3


def encoded(image, kind, **options):
    buffer = BytesIO()
    image.save(buffer, kind, **options)
    return buffer.getvalue()


def read(tmp_path, content, name="picture.png", **options):
    path = tmp_path / name
    path.write_bytes(content)
    return read_photo(path, **options)


def tiff(values, bits, photometric=1):
    """A little-endian one-row TIFF of one sample per pixel, written by hand."""
    strip = values.tobytes()
    entries = [(256, values.size), (257, 1), (258, bits), (259, 1), (262, photometric)]
    entries += [(273, 8), (277, 1), (278, 1), (279, len(strip))]
    table = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in entries)
    directory = struct.pack("<H", len(entries)) + table + bytes(4)
    return b"II*\0" + struct.pack("<I", 8 + len(strip)) + strip + directory


def png(width, height, depth, colour, rows):
    """A PNG written by hand, for what Pillow does not write."""

    def chunk(kind, body):
        check = zlib.crc32(kind + body)
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", check)

    header = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    body = zlib.compress(b"".join(b"\0" + row for row in rows))
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")
    )


def corners(photo):
    return [tuple(photo.pixels[y, x].tolist()) for y in (0, -1) for x in (0, -1)]


# A picture of 2 x 3 with a colour in each corner, as it looks: red green / blue white.
# Each orientation says where the file's first row and first column are seen (EXIF 2.32, 4.6.4).
STORED = {
    1: [[RED, GREEN], [BLUE, WHITE]],
    2: [[GREEN, RED], [WHITE, BLUE]],
    3: [[WHITE, BLUE], [GREEN, RED]],
    4: [[BLUE, WHITE], [RED, GREEN]],
    5: [[RED, BLUE], [GREEN, WHITE]],
    6: [[GREEN, WHITE], [RED, BLUE]],
    7: [[WHITE, GREEN], [BLUE, RED]],
    8: [[BLUE, RED], [WHITE, GREEN]],
}


@pytest.mark.parametrize("kind", ["PNG", "TIFF", "JPEG", "WEBP"])
@pytest.mark.parametrize("orientation", STORED)
def test_a_turned_picture_is_seen_upright(tmp_path, kind, orientation):
    small = np.array(STORED[orientation], np.uint8)
    sideways = orientation >= 5
    stored = small.repeat(16 if sideways else 32, axis=0).repeat(32 if sideways else 16, axis=1)
    exif = Image.Exif()
    exif[0x0112] = orientation
    lossless = {"JPEG": {"quality": 100, "subsampling": 0}, "WEBP": {"lossless": True}}
    content = encoded(Image.fromarray(stored), kind, exif=exif, **lossless.get(kind, {}))
    photo = read(tmp_path, content, f"a.{kind.lower()}")
    assert photo.pixels.shape == (64, 32, 3)
    assert np.abs(np.array(corners(photo)) - [RED, GREEN, BLUE, WHITE]).max() <= 3
    assert not photo.warnings


def test_gray_becomes_three_equal_channels(tmp_path):
    image = Image.fromarray(np.array([[0, 77, 255]], np.uint8))
    assert read(tmp_path, encoded(image, "PNG")).pixels.tolist() == [[[0] * 3, [77] * 3, [255] * 3]]


def test_one_bit_becomes_black_and_white(tmp_path):
    image = Image.fromarray(np.array([[True, False]]))
    assert read(tmp_path, encoded(image, "PNG")).pixels.tolist() == [[list(WHITE), list(BLACK)]]


def test_a_palette_becomes_its_colours(tmp_path):
    image = Image.fromarray(np.array([[1, 0]], np.uint8), "P")
    image.putpalette([*RED, *BLUE])
    assert read(tmp_path, encoded(image, "PNG")).pixels.tolist() == [[list(BLUE), list(RED)]]


@pytest.mark.parametrize("transparency", [1, b"\xff\x00"])
def test_a_transparent_palette_entry_becomes_white(tmp_path, transparency):
    image = Image.fromarray(np.array([[1, 0]], np.uint8), "P")
    image.putpalette([*RED, *BLUE])
    photo = read(tmp_path, encoded(image, "PNG", transparency=transparency))
    assert photo.pixels.tolist() == [[list(WHITE), list(RED)]]
    assert not photo.warnings


def test_alpha_is_laid_on_white(tmp_path):
    image = Image.fromarray(np.array([[(200, 0, 0, 0), (0, 0, 0, 51), (9, 8, 7, 255)]], np.uint8))
    expected = [[list(WHITE), [204] * 3, [9, 8, 7]]]
    assert read(tmp_path, encoded(image, "PNG")).pixels.tolist() == expected


def test_gray_with_alpha_is_laid_on_white(tmp_path):
    image = Image.fromarray(np.array([[(0, 0), (0, 51), (9, 255)]], np.uint8), "LA")
    expected = [[list(WHITE), [204] * 3, [9] * 3]]
    assert read(tmp_path, encoded(image, "PNG")).pixels.tolist() == expected


def test_gray_premultiplied_by_alpha_is_laid_on_white(tmp_path):
    content = encoded(Image.fromarray(np.array([[(102, 128)]], np.uint8), "LA"), "TIFF")
    kind = struct.pack("<HHI", 338, 3, 1)  # ExtraSamples: 2 is plain alpha, 1 premultiplied
    assert kind + b"\2" in content
    pixels = read(tmp_path, content.replace(kind + b"\2", kind + b"\1"), "a.tif").pixels
    assert abs(int(pixels[0, 0, 0]) - 229) <= 1  # 102 + 255 (1 - 128 / 255)


def test_cmyk_is_seen_in_its_colours(tmp_path):
    image = Image.new("CMYK", (8, 8), (0, 255, 255, 0))
    pixels = read(tmp_path, encoded(image, "JPEG", quality=100), "a.jpg").pixels
    assert np.abs(pixels.astype(int) - RED).max() <= 2


def test_lab_is_seen_in_its_colours(tmp_path):
    image = Image.new("LAB", (2, 2), (136, 209, 195))
    pixels = read(tmp_path, encoded(image, "TIFF"), "a.tif").pixels  # red: L 53, a 80, b 67
    assert np.abs(pixels.astype(int) - RED).max() <= 12


SIXTEEN = np.array([[0, 257, 128 * 257, 65535]], np.uint16)
EIGHT = [[[level] * 3 for level in (0, 1, 128, 255)]]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("gray.png", encoded(Image.fromarray(SIXTEEN), "PNG")),
        ("rgb.png", png(4, 1, 16, 2, [SIXTEEN.astype(">u2").repeat(3).tobytes()])),
        ("gray.tif", encoded(Image.fromarray(SIXTEEN), "TIFF")),
        ("lzw.tif", encoded(Image.fromarray(SIXTEEN), "TIFF", compression="tiff_lzw")),
        ("white_is_zero.tif", tiff(65535 - SIXTEEN, 16, photometric=0)),
        ("gray.pgm", b"P5 4 1 65535\n" + SIXTEEN.astype(">u2").tobytes()),
    ],
)
def test_sixteen_bits_are_scaled_to_eight(tmp_path, name, content):
    assert read(tmp_path, content, name).pixels.tolist() == EIGHT


def test_sixteen_bits_are_rounded_to_the_nearest_level(tmp_path):
    image = Image.fromarray(np.array([[128, 129, 65535 - 129]], np.uint16))
    assert read(tmp_path, encoded(image, "PNG")).pixels[0, :, 0].tolist() == [0, 1, 254]


def test_the_transparent_shade_of_a_deep_gray_png_becomes_white(tmp_path):
    content = encoded(Image.fromarray(SIXTEEN), "PNG", transparency=257)
    assert read(tmp_path, content).pixels[0, :, 0].tolist() == [0, 255, 128, 255]


@pytest.mark.parametrize(("white", "said"), [(1, "1 as white"), (65535, "65535 as white")])
def test_a_float_tiff_is_scaled_to_its_white(tmp_path, white, said):
    values = np.array([[0, 0.5, 1]], np.float32) * np.float32(white)
    photo = read(tmp_path, encoded(Image.fromarray(values), "TIFF"), "a.tif")
    assert photo.pixels[0, :, 0].tolist() == [0, 128, 255]
    assert said in photo.warnings[0]


@pytest.mark.parametrize("wrong", [-1, 1e6, np.nan, np.inf])
def test_floats_that_are_no_shades_are_refused(tmp_path, wrong):
    content = encoded(Image.fromarray(np.array([[0, wrong]], np.float32)), "TIFF")
    with pytest.raises(InputError, match="not shades of gray"):
        read(tmp_path, content, "a.tif")


@pytest.mark.parametrize("kind", ["GIF", "PNG", "WEBP"])
def test_of_an_animation_the_first_frame_is_read(tmp_path, kind):
    first, second = Image.new("RGB", (5, 4), RED), Image.new("RGB", (5, 4), BLUE)
    content = encoded(first, kind, save_all=True, append_images=[second], lossless=True)
    pixels = read(tmp_path, content, f"a.{kind.lower()}").pixels
    assert (pixels == RED).all()
    assert pixels.shape == (4, 5, 3)


@pytest.mark.parametrize("size", [(1, 1), (1, 5000), (5000, 1)])
def test_the_thinnest_pictures_are_read(tmp_path, size):
    photo = read(tmp_path, encoded(Image.new("RGB", size, GREEN), "PNG"))
    assert photo.pixels.shape == (size[1], size[0], 3)
    assert (photo.pixels == GREEN).all()


def swapped_profile():
    """Return an sRGB profile with red and green swapped, under a name of its own."""
    swapped = bytearray(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())
    swapped = swapped.replace(b"rXYZ", b"tXYZ").replace(b"gXYZ", b"rXYZ").replace(b"tXYZ", b"gXYZ")
    swapped = swapped.replace("sRGB".encode("utf-16-be"), "swap".encode("utf-16-be"))
    return bytes(swapped)


def test_an_embedded_profile_is_followed(tmp_path):
    content = encoded(Image.new("RGB", (2, 2), RED), "PNG", icc_profile=swapped_profile())
    photo = read(tmp_path, content)
    assert np.abs(photo.pixels.astype(int) - GREEN).max() <= 2
    assert not photo.warnings


def test_a_profile_of_another_kind_of_picture_is_passed_over(tmp_path):
    content = encoded(Image.new("L", (2, 2), 77), "PNG", icc_profile=swapped_profile())
    photo = read(tmp_path, content)
    assert (photo.pixels == 77).all()
    assert not photo.warnings


def test_a_damaged_profile_is_ignored_with_a_warning(tmp_path):
    photo = read(tmp_path, encoded(Image.new("RGB", (2, 2), RED), "PNG", icc_profile=b"rubbish"))
    assert (photo.pixels == RED).all()
    assert "colour profile" in photo.warnings[0]


def test_a_wrong_extension_is_read_with_a_warning_that_names_the_file(tmp_path):
    photo = read(tmp_path, encoded(Image.new("RGB", (2, 2), RED), "PNG"), "holiday.jpg")
    assert (photo.pixels == RED).all()
    assert len(photo.warnings) == 1
    assert "holiday.jpg: holds a PNG picture" in photo.warnings[0]


@pytest.mark.parametrize("name", ["a.JPG", "b.jpeg", "c"])
def test_a_right_extension_gives_no_warning(tmp_path, name):
    assert not read(tmp_path, encoded(Image.new("RGB", (2, 2)), "JPEG"), name).warnings


def test_of_several_jpegs_in_one_file_the_first_is_read_without_a_warning(tmp_path):
    depth = Image.new("RGB", (3, 3))
    content = encoded(Image.new("RGB", (8, 6)), "MPO", save_all=True, append_images=[depth])
    photo = read(tmp_path, content, "phone.jpg")
    assert photo.pixels.shape == (6, 8, 3)
    assert not photo.warnings


@pytest.mark.parametrize(
    ("film", "expected"),
    [(26, 26 / 43.27), (0, None), (1, None), (65535, None), ((26, 27), None), (None, None)],
)
def test_the_focal_length_comes_from_exif(tmp_path, film, expected):
    exif = Image.Exif()
    exif[0x0112] = 6
    if film is not None:
        exif.get_ifd(0x8769)[41989] = film
    photo = read(tmp_path, encoded(Image.new("RGB", (4, 2)), "JPEG", exif=exif), "a.jpg")
    assert photo.focal_in_diagonals == (expected and pytest.approx(expected, abs=1e-9))
    assert photo.pixels.shape == (4, 2, 3)


def test_damaged_exif_does_not_cost_the_picture(tmp_path):
    content = encoded(
        Image.new("RGB", (4, 2)), "PNG", exif=b"Exif\0\0II*\0\xff\xff\xff\x7f rubbish"
    )
    photo = read(tmp_path, content)
    assert photo.pixels.shape == (2, 4, 3)
    assert photo.focal_in_diagonals is None
    assert all(str(tmp_path / "picture.png") in warning for warning in photo.warnings)
    assert any("EXIF" in warning for warning in photo.warnings)


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("a.jpg", b"", "empty"),
        ("a.jpg", b"this is no picture at all", "no picture"),
        ("a.dng", b"II*\0\x08\0\0\0", "raw"),
        ("a.png", encoded(Image.effect_noise((64, 64), 50), "PNG")[:2000], "truncated"),
        ("a.jpg", encoded(Image.effect_noise((64, 64), 50), "JPEG")[:1500], "truncated"),
    ],
)
def test_what_is_no_whole_picture_is_refused_in_one_line(tmp_path, name, content, reason):
    with pytest.raises(InputError, match=reason) as refused:
        read(tmp_path, content, name)
    assert str(tmp_path / name) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_heic_without_its_extra_says_which_one_reads_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pillow_heif", None)
    content = b"\0\0\0\x18ftypheic\0\0\0\0mif1heic"
    with pytest.raises(InputError, match=r'a\.heic: is HEIC; pip install "flexdepth\[heic\]"'):
        read(tmp_path, content, "a.heic")


def test_a_phones_heic_is_read_upright_with_its_colours_and_its_focal_length(tmp_path):
    heif = pytest.importorskip("pillow_heif")
    exif = Image.Exif()
    exif[0x0112] = 6
    exif.get_ifd(0x8769)[41989] = 26
    lying = Image.new("RGB", (96, 64), RED)
    lying.paste(GREEN, (0, 0, 96, 32))  # Turned to the right, above becomes right.
    heif.from_pillow(lying).save(tmp_path / "a.heic", exif=exif.tobytes(), quality=95)
    content = (tmp_path / "a.heic").read_bytes()
    photo = read(tmp_path, content, "a.heic")
    assert photo.pixels.shape == (96, 64, 3)
    for columns, colour in ((slice(8, 24), RED), (slice(40, 56), GREEN)):
        assert np.abs(photo.pixels[:, columns].astype(int) - colour).max() <= 12
    assert photo.focal_in_diagonals == pytest.approx(26 / 43.27)
    assert not photo.warnings
    with pytest.raises(InputError, match="has 64 x 96 pixels, the limit is 6143"):
        read(tmp_path, content, "a.heic", max_pixels=6143)
    with pytest.raises(InputError, match=r"a\.heic: is truncated or damaged"):
        read(tmp_path, content[: len(content) // 2], "a.heic")


@pytest.mark.skipif(not features.check("avif"), reason="this Pillow was built without AVIF")
@pytest.mark.parametrize("keep", [0.5, 0.9])
def test_a_truncated_avif_is_refused(tmp_path, keep):
    content = encoded(Image.effect_noise((64, 64), 50), "AVIF")
    assert read(tmp_path, content, "a.avif").pixels.shape == (64, 64, 3)
    with pytest.raises(InputError, match=r"a\.avif: is"):
        read(tmp_path, content[: int(keep * len(content))], "a.avif")


def test_the_limit_on_pixels_is_kept_to_the_pixel(tmp_path):
    content = encoded(Image.new("L", (30, 10)), "PNG")
    assert read(tmp_path, content, max_pixels=300).pixels.shape == (10, 30, 3)
    with pytest.raises(InputError, match=r"^\S+picture.png: has 30 x 10 pixels, the limit is 299;"):
        read(tmp_path, content, max_pixels=299)


def test_too_many_pixels_are_refused_before_they_are_decoded(tmp_path):
    content = png(60_000, 60_000, 8, 2, [b"no pixels follow"])
    with pytest.raises(InputError, match="60000 x 60000 pixels"):
        read(tmp_path, content)


def test_a_frame_that_is_larger_than_its_header_says_is_refused(tmp_path):
    content = bytearray(encoded(Image.new("L", (4, 4)), "GIF"))
    frame = content.rindex(b",\0\0\0\0")
    content[frame + 5 : frame + 9] = struct.pack("<HH", 60_000, 60_000)
    with pytest.raises(InputError, match="60000 x 60000 pixels"):
        read(tmp_path, content, "a.gif")


def test_twelve_bits_are_scaled_to_eight(tmp_path):
    packed = np.array([0xFF, 0xF0, 0x00, 0x80, 0x00, 0x00], np.uint8)  # fff 000 800 000
    content = tiff(packed, 12).replace(
        struct.pack("<HHII", 256, 4, 1, 6), struct.pack("<HHII", 256, 4, 1, 4)
    )
    assert read(tmp_path, content, "a.tif").pixels[0, :, 0].tolist() == [255, 0, 128, 0]


def test_pillows_own_limit_neither_stops_a_picture_nor_is_changed(tmp_path, monkeypatch):
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 10)
    for kind in ("PNG", "TIFF", "GIF", "WEBP"):
        photo = read(tmp_path, encoded(Image.new("L", (30, 10)), kind), f"a.{kind.lower()}")
        assert photo.pixels.shape == (10, 30, 3)
        assert not photo.warnings
    with pytest.raises(InputError):
        read(tmp_path, b"rubbish")
    assert Image.MAX_IMAGE_PIXELS == 10


@pytest.mark.parametrize(
    ("name", "expected"),
    [("a.JPG", True), ("a.tiff", True), ("a.HEIC", True), ("a.mp4", False), ("jpg", False)],
)
def test_pictures_are_known_by_name_in_a_folder(tmp_path, name, expected):
    assert is_picture_name(tmp_path / name) is expected


def test_the_photos_in_a_folder_are_listed_by_their_paths(tmp_path):
    own = [f"{number:02d}.PNG" for number in range(20)]
    below = ["below/c.jpg", "folder.jpg/d.png"]
    for name in ("notes.txt", *below, *reversed(own)):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert photos_in(tmp_path, "*") == [tmp_path / name for name in own]
    assert photos_in(tmp_path, "**/*") == [tmp_path / name for name in (*own, *below)]


def small_pictures():
    pixels = np.random.default_rng(0).integers(0, 256, (7, 9, 3), np.uint8)
    image = Image.fromarray(pixels)
    exif = Image.Exif()
    exif[0x0112] = 6
    exif.get_ifd(0x8769)[41989] = 26
    kinds = ("PNG", "JPEG", "TIFF", "GIF", "WEBP", "BMP", "PPM")
    whole = [encoded(image, kind, exif=exif) for kind in kinds]
    whole.append(encoded(image, "JPEG", exif=exif, progressive=True))
    whole.append(encoded(image, "TIFF", exif=exif, compression="tiff_adobe_deflate"))
    whole.append(encoded(image.quantize(16), "PNG", transparency=3))
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    whole.append(encoded(image, "PNG", icc_profile=profile.replace(b"s\0R\0G", b"x\0y\0z")))
    return whole


PICTURES = small_pictures()


@given(
    which=st.integers(0, len(PICTURES) - 1),
    keep=st.floats(0, 1),
    flips=st.lists(st.tuples(st.floats(0, 1, exclude_max=True), st.integers(1, 255)), max_size=4),
)
@example(which=0, keep=1.0, flips=[])
def test_damage_gives_a_picture_or_an_input_error_and_nothing_else(
    tmp_path_factory, which, keep, flips
):
    content = bytearray(PICTURES[which])
    for where, mask in flips:
        content[int(where * len(content))] ^= mask
    path = tmp_path_factory.getbasetemp() / "damaged.png"
    path.write_bytes(content[: round(keep * len(content))])
    try:
        photo = read_photo(path, max_pixels=1_000_000)
    except InputError as refused:
        message = str(refused)
    else:
        message = f"{path}"
        assert photo.pixels.dtype == np.uint8
        assert photo.pixels.ndim == 3
    assert str(path) in message
    assert "\n" not in message
