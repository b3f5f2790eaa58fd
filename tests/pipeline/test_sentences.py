"""The sentence below a field is found where pydantic itself finds it."""

from pydantic import BaseModel, ConfigDict

from kinetree.pipeline.settings.sentences import sentences


class Shape(BaseModel):
    """A base whose sentences its subclasses keep."""

    model_config = ConfigDict(use_attribute_docstrings=True)

    size: float = 1.0
    """How large."""
    name: str = ""
    untold: int = 0


class Sphere(Shape):
    """Says one thing anew, and adds some."""

    name: str = "sphere"
    """What it is called,
    on two lines."""
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Where."""
    LIMIT: int = 3
    "Quoted once."

    def volume(self) -> float:
        """No field."""
        return 4.19 * self.size**3


def test_sentences_are_those_of_pydantic():
    for model in (Shape, Sphere):
        assert sentences(model) == {name: f.description for name, f in model.model_fields.items() if f.description}
    assert sentences(Sphere) == {
        "size": "How large.",
        "name": "What it is called,\non two lines.",
        "centre": "Where.",
        "LIMIT": "Quoted once.",
    }


def test_a_model_without_source_has_no_sentences():
    space: dict[str, object] = {"BaseModel": BaseModel, "__name__": "nowhere"}
    exec("class Made(BaseModel):\n    size: float\n    'How large.'", space)
    assert sentences(space["Made"]) == {}
