"""Words in messages."""

from vitruvius.logic.spelling import article


def test_a_noun_has_the_article_with_which_it_is_spoken() -> None:
    nouns = "bedroom", "openspace", "Aisle", "hall", "utility", "unit", "umbrellaStand"
    assert [article(noun) for noun in nouns] == [
        "a bedroom",
        "an openspace",
        "an Aisle",
        "a hall",
        "a utility",
        "a unit",
        "an umbrellaStand",
    ]
