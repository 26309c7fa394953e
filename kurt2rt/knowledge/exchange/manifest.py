"""What an exported file says of itself."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError

from kurt2rt.core.rla.feature_set import LevelFeatures
from kurt2rt.knowledge.exchange.json_checks import require_text
from kurt2rt.knowledge.journal.binding import KnowledgeBinding

_Text = Annotated[str, AfterValidator(require_text)]


class _Features(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True)
    hash: _Text
    names: list[_Text]

    @property
    def of_level(self) -> LevelFeatures:
        return LevelFeatures(self.hash, tuple(self.names))


class Manifest(BaseModel):
    """What an import needs of it; it may say more."""

    model_config = ConfigDict(strict=True, frozen=True)
    task: _Text
    """Name of the task whose settings are in the file."""
    exported_at: _Text
    """UTC, ISO 8601."""
    system: _Text
    robot: _Text
    features: _Features
    levels: dict[_Text, _Features]

    @property
    def binding(self) -> KnowledgeBinding:
        """What the knowledge in the file is bound to."""
        basic = self.features.of_level
        levels = {level: features.of_level for level, features in self.levels.items()}
        return KnowledgeBinding(basic.feature_hash, basic.feature_names, self.system, self.robot, levels)


def read_manifest(content: Mapping[str, Any]) -> Manifest:
    """The manifest in what its JSON says. Raises ValueError."""
    try:
        return Manifest.model_validate(content)
    except ValidationError as error:
        problem = error.errors(include_url=False)[0]
        raise ValueError(f"its manifest: {'.'.join(map(str, problem['loc']))}: {problem['msg']}") from error
