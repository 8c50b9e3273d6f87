import pytest

from flexdepth.hub.model_card import stated_licence


@pytest.mark.parametrize(
    ("text", "licence"),
    [
        ("---\nlicense: apache-2.0\ntags:\n- vision\n---\nwords", "apache-2.0"),
        ("---\r\nlicense: mit\r\n---\r\n", "mit"),
        ("---\nlicense: other\nlicense_name: apple-amlr\n---\n", "apple-amlr"),
        ("---\nlicense: other\n---\n", "other"),
        ("---\ntags: []\n---\n", None),
        ("# no front\nlicense: mit", None),
        ("---\n{broken: [\n---\n", None),
        ("---\n- a list\n---\n", None),
        ("---\nlicense: [a, b]\n---\n", None),
        ("", None),
    ],
)
def test_a_card_states_its_licence_in_its_front_matter(text, licence, tmp_path):
    card = tmp_path / "README.md"
    card.write_bytes(text.encode())
    assert stated_licence(card) == licence
