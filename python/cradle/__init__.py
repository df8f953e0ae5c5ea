"""Rigid-body physics from a scene file, and pictures of it.

    import cradle
    motion = cradle.simulate("newtons_cradle.json")
    motion.positions                      # (frames, bodies, 3), m
    cradle.render(motion, 10)             # (height, width, 3), uint8

All numbers are in SI units; docs/python.md says more.
"""
import atexit
import base64
import collections.abc
import json
import operator
import os
import threading
import weakref

from . import _cradle
from ._cradle import Body, ContactForce, Error, Event, FailedCheck, Film, Scene, __version__

__all__ = ["Body", "ContactForce", "Error", "Event", "FailedCheck", "Film", "Scene", "Trajectory", "load", "render",
           "simulate"]


class Trajectory(_cradle.Trajectory):
    """A motion: a trajectory file, or what simulate() returns.

    Arrays are views of one copy of the states, which is read when the first of them is asked for.
    """

    __slots__ = ()

    @property
    def bodies(self):
        """Names of the bodies that move, in the order of the arrays."""
        names = self.all_bodies
        return [names[index] for index in self.moving_bodies]

    def to_pandas(self):
        """A data frame with a row for each frame and body: frame, time, body, position, orientation, velocities."""
        import numpy
        import pandas
        bodies = self.bodies
        frames = len(self.times)
        columns = {"frame": numpy.repeat(numpy.arange(frames), len(bodies)), "time": numpy.repeat(self.times, len(bodies)),
                   "body": pandas.Categorical.from_codes(numpy.tile(numpy.arange(len(bodies)), frames), dtype=None,
                                                         categories=bodies)}
        for names, array in ((("px", "py", "pz"), self.positions), (("qw", "qx", "qy", "qz"), self.orientations),
                             (("vx", "vy", "vz"), self.linear_velocities), (("wx", "wy", "wz"), self.angular_velocities)):
            for i, name in enumerate(names):
                columns[name] = array[:, :, i].reshape(-1)
        return pandas.DataFrame(columns)

    def _repr_html_(self):
        """The motion as notebooks show it: a player to walk around in."""
        page = base64.b64encode(self.player_page().encode()).decode()
        return ('<iframe src="data:text/html;base64,%s" style="width: 100%%; height: 500px; border: 0" allowfullscreen>'
                "</iframe>" % page)

    def __repr__(self):
        return "<cradle.Trajectory of %d frames>" % len(self)

    def __len__(self):
        return len(self.times)


def _plain(value):
    """Arrays and numbers of NumPy, and paths, as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError("%r is nothing that a scene can hold" % (value,))


def load(scene):
    """Reads a scene: the path of a scene file, or a dict of what would be in it.

    A dict may hold arrays and numbers of NumPy; its meshes are looked for from the current folder. Raises Error with
    every fault, and where it is.
    """
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, collections.abc.Mapping):
        return Scene.parse(json.dumps(dict(scene), default=_plain), "scene")
    if not isinstance(scene, (str, bytes, os.PathLike)):
        raise TypeError("a scene is a path or a dict, not %r" % (scene,))
    return Scene.load(scene)


def simulate(scene, progress=None):
    """Simulates a scene (a Scene, a path or a dict), and returns its Trajectory.

    `progress(time, duration)` is called after each frame, and once a second inside one that takes longer; in s. Other
    threads of Python run meanwhile. Warnings are raised as UserWarning; errors as Error; Ctrl-C ends it.
    """
    return Trajectory(_cradle.simulate(load(scene), progress))


_latest = (None, None, None)  # what has drawn the latest picture: its trajectory, how, and the film
_latest_lock = threading.Lock()
atexit.register(_cradle._await_others)


def _size_of(size):
    if size is None:
        return None
    try:
        width, height = (operator.index(length) for length in size)
    except (TypeError, ValueError):
        raise TypeError("size is (width, height) in pixels, as (640, 360), not %r" % (size,)) from None
    return width, height


def render(trajectory, frame, size=None, overlay=""):
    """The picture of a frame as an array (height, width, 3) of uint8, sRGB.

    `size` is (width, height) in pixels; by default the scene's. `overlay` is that of `cradle render --overlay`, as
    "time,contacts". What has drawn the latest picture (some 35 MB) is kept for the next one of that trajectory.
    """
    global _latest
    if not isinstance(trajectory, _cradle.Trajectory):
        raise TypeError("a cradle.Trajectory is drawn, not %r" % (trajectory,))
    how = (_size_of(size), overlay)
    with _latest_lock:
        drawn, drawn_how, film = _latest
        if film is None or drawn() is not trajectory or drawn_how != how:
            film = None
            _latest = (None, None, None)  # the old one goes first
            film = Film(trajectory, *how)
            _latest = (weakref.ref(trajectory, _forget), how, film)
        return film.draw(operator.index(frame))


def _forget(reference):
    global _latest
    if _latest[0] is reference:
        _latest = (None, None, None)
