import os
from collections.abc import Mapping
from typing import Any, Callable, List, Optional, Sequence, Union

import numpy
import pandas
from numpy.typing import NDArray

from . import _cradle
from ._cradle import Body as Body, ContactForce as ContactForce, Error as Error, Event as Event
from ._cradle import FailedCheck as FailedCheck, Film as Film, Scene as Scene

__version__: str

class Trajectory(_cradle.Trajectory):
    @property
    def bodies(self) -> List[str]: ...
    def to_pandas(self) -> pandas.DataFrame: ...
    def __len__(self) -> int: ...

SceneSource = Union[Scene, str, bytes, os.PathLike[str], Mapping[str, Any]]

def load(scene: SceneSource) -> Scene: ...
def simulate(scene: SceneSource, progress: Optional[Callable[[float, float], None]] = None) -> Trajectory: ...
def render(trajectory: Trajectory, frame: int, size: Optional[Sequence[int]] = None,
           overlay: str = "") -> NDArray[numpy.uint8]: ...
