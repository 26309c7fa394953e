"""Jobs of which a result and a knowledge file are kept, both by one name."""

from pathlib import Path

from kurt2rt.experiments.study.results import Results


class StoredPaths:
    """Names the files of such a job; a subclass has the folder of results, and says the name."""

    __slots__ = ()
    results: Results

    @property
    def stem(self) -> str:
        """Name of its files, with folders and without ending."""
        raise NotImplementedError

    @property
    def file(self) -> str:
        """Path within the folder of results."""
        return f"results/{self.stem}.json"

    @property
    def knowledge(self) -> Path:
        """Where what it was taught is kept."""
        return self.results.folder / self._kept

    def keep(self, knowledge: Path) -> None:
        """Keep this file as what it was taught."""
        self.results.keep(knowledge, self._kept)

    @property
    def _kept(self) -> str:
        return f"knowledge/{self.stem}.knowledge"
