"""Rigid-body physics from a scene file, and pictures of it.

    import cradle
    motion = cradle.simulate("newtons_cradle.json")
    motion.positions                      # (frames, bodies, 3), m
    cradle.render(motion, 10)             # (height, width, 3), uint8

All numbers are in SI units; docs/python.md says more.
"""
import base64
import json
import os

from . import _cradle
from ._cradle import Body, ContactForce, Error, Event, FailedCheck, Film, Scene, __version__

__all__ = ["Body", "ContactForce", "Error", "Event", "FailedCheck", "Film", "Scene", "Trajectory", "load", "render",
           "simulate"]


class Trajectory(_cradle.Trajectory):
    """A motion: a trajectory file, or what simulate() returns.

    Arrays are views of one copy of the states, which is read when the first of them is asked for.
    """

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
        return "<cradle.Trajectory of %d frames>" % len(self.times)


def _plain(value):
    """Arrays and numbers of NumPy as JSON has them."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError("%r is nothing that a scene can hold" % (value,))


def load(scene):
    """Reads a scene: the path of a scene file, or a dict of what would be in it.

    A dict may hold arrays and numbers of NumPy; its meshes are looked for from the current folder. Raises Error with
    every fault, and where it is.
    """
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, dict):
        return Scene.parse(json.dumps(scene, default=_plain))
    return Scene.load(os.fspath(scene))


def simulate(scene, progress=None):
    """Simulates a scene (a Scene, a path or a dict), and returns its Trajectory.

    `progress(time, duration)` is called after each frame, in s. Other threads of Python run meanwhile. Warnings are
    raised as UserWarning; errors as Error; Ctrl-C ends it.
    """
    return Trajectory(_cradle.simulate(load(scene), progress))


def render(trajectory, frame, size=None, overlay=""):
    """The picture of a frame as an array (height, width, 3) of uint8, sRGB.

    `size` is (width, height) in pixels; by default the scene's. `overlay` is that of `cradle render --overlay`, as
    "time,contacts". What draws the picture is kept for the next one of that trajectory.
    """
    width, height = size or (0, 0)
    key = (width, height, overlay)
    kept = getattr(trajectory, "_film", None)
    if kept is None or kept[0] != key:
        kept = trajectory._film = (key, Film(trajectory, width, height, overlay))
    return kept[1].draw(frame)
