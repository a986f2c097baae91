"""The words of the house: the list tells the words it names, in names and prose, and leaves alone what is quoted."""

import re
from pathlib import Path

import pytest
import words

BRITISH = "discretised neighbouring centred CENTRE component_colours Linearisation labelled grey towards"
AMERICAN = "discretized neighboring centered CENTER component_colors Linearization labeled gray toward"
OTHERS = "CancelledError otherwise precise raise optimistix labelleft four generalist analysis fulfilled promised arise"


def _complaints(text: str, name: str = "a.py") -> list[str]:
    return [complaint for _, complaint in words.words(name, text, words.TABLE["spelling"] | words.TABLE["phrases"])]


@pytest.mark.parametrize(("word", "american"), [*zip(BRITISH.split(), AMERICAN.split(), strict=True)])
def test_words_are_noticed(word: str, american: str) -> None:
    """A British word is noticed, inside a name too, once, and its American form is none."""
    assert len(_complaints(f"x {word} y")) == 1
    assert _complaints(f"x {american} y") == []


def test_phrases_are_noticed_over_line_ends() -> None:
    """Phrases are noticed wherever lines end."""
    assert len(_complaints("a run that cannot be gone\n    on with, of your\nown; told")) == 2


DIALECT = "What is kept has names./It says why./in whatever case/a body of its own/in the place of/done anew"
PLAIN = "Cases. That body/about one of its own axes/What works with what/How far does it turn?/It is asked."


@pytest.mark.parametrize(("sentences", "count"), [(DIALECT, 1), (PLAIN, 0)], ids=["dialect", "plain"])
def test_dialect_is_noticed_on_pages(sentences: str, count: int) -> None:
    """The dialect of the list is noticed, once; sentences that only begin like it are none."""
    for sentence in sentences.split("/"):
        assert len(list(words.words("docs/a.md", sentence, words.TABLE["prose"]))) == count, sentence


def test_handwritten_pages_stay_short() -> None:
    """The pages that no script writes have no more words than their limit; pages of scripts are not among them."""
    lengths = words.lengths()
    assert words.too_long(lengths) == []
    assert "conventions.md" in lengths
    assert not {"paper.md", "errata.md", "api/index.md", "reference/scenarios.md", "gallery/README.md"} & set(lengths)


@pytest.mark.parametrize("word", OTHERS.split())
def test_other_words_are_left_alone(word: str) -> None:
    """Words that only look like one of the list are none."""
    assert _complaints(f"x {word} y") == []


def test_quotations_are_left_alone() -> None:
    """The words of others, titles of works in the references and past releases of the changelog are theirs."""
    assert _complaints("“behaviour” “the centre”") == []
    assert _complaints("| [key] | A. Author, *The geometric discretisation* |", "docs/references.md") == []
    assert len(_complaints("| [key] | A. Author, *The geometric discretisation* |", "docs/house.md")) == 1
    assert len(_complaints("## [Unreleased]\ncolour\n## [0.1.0] - 2025\ncolour\n", "CHANGELOG.md")) == 1


def test_every_exception_is_needed() -> None:
    """Each exception of the list stands in its file and has a word of the list in it."""
    for name, fragments in words.TABLE["allowed"].items():
        text = (words.ROOT / Path(name)).read_text("utf-8")
        for fragment in fragments:
            assert fragment in text
            patterns = words.TABLE["spelling"] | words.TABLE["phrases"]
            assert any(re.search(pattern, fragment, re.IGNORECASE) for pattern in patterns)
