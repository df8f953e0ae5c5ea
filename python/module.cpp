// The module cradle._cradle: the library's face (include/cradle) for Python. python/cradle adds what Python does best.

#include <cradle/render.h>
#include <cradle/simulate.h>
#include <cradle/watch.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace py = pybind11;
using namespace py::literals;

namespace {

using namespace cradle::v1;

/// Work that Python waits for before it ends: a thread that came back to it afterwards would be taken apart inside C++.
class Busy {
 public:
  Busy() {
    ++count();  // before the look, so that Python waits for this one or this one sees the end
    if (!isEnding()) return;
    --count();
    requireTime();
  }
  ~Busy() { --count(); }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

  /// Throws once Python ends.
  static void requireTime() {
    if (isEnding()) throw Error(ErrorKind::usage, "the interpreter ends, and this thread with it");
  }

  /// To be called when Python ends.
  static void awaitOthers() {
    isEnding() = true;
    const py::gil_scoped_release released;
    while (count() > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

 private:
  static std::atomic<int>& count() {
    static std::atomic<int> count = 0;
    return count;
  }
  static std::atomic<bool>& isEnding() {
    static std::atomic<bool> isEnding = false;
    return isEnding;
  }
};

/// The states of a trajectory, frame by frame, so that NumPy sees each kind as one array.
struct States {
  std::size_t frames = 0, bodies = 0, joints = 0;
  std::vector<Vector3> positions, linearVelocities, angularVelocities;  // frames * bodies
  std::vector<Quaternion> orientations;                                 // frames * bodies
  std::vector<EnergyBalance> energy;                                    // frames
  std::vector<double> coordinates, velocities, forces;                  // of joints: frames * joints
};

std::shared_ptr<const States> statesOf(const Trajectory& trajectory) {
  auto states = std::make_shared<States>();
  states->frames = static_cast<std::size_t>(trajectory.frameCount());
  states->bodies = trajectory.movingBodies().size();
  states->joints = trajectory.joints().size();
  for (long number = 0; number < trajectory.frameCount(); ++number) {
    const Frame frame = trajectory.frame(number);
    for (const BodyState& state : frame.states) {
      states->positions.push_back(state.position);
      states->orientations.push_back(state.orientation);
      states->linearVelocities.push_back(state.linearVelocity);
      states->angularVelocities.push_back(state.angularVelocity);
    }
    states->energy.push_back(frame.energy);
    for (const JointState& joint : frame.joints) {
      states->coordinates.push_back(joint.coordinate);
      states->velocities.push_back(joint.velocity);
      states->forces.push_back(joint.force);
    }
  }
  return states;
}

/// A trajectory, with its states once they were asked for. Copies share it, and threads take turns.
class Motion {
 public:
  explicit Motion(Trajectory trajectory) : shared_(std::make_shared<Shared>(std::move(trajectory))) {}

  /// What ask(trajectory) returns; other threads of Python go on meanwhile.
  template <class Ask>
  auto alone(const Ask& ask) const {
    const Busy busy;
    const py::gil_scoped_release released;
    const std::lock_guard lock(shared_->mutex);
    return ask(shared_->trajectory);
  }

  const std::shared_ptr<const std::vector<double>>& times() const { return shared_->times; }

  std::shared_ptr<const States> states() const {
    return alone([this](const Trajectory& trajectory) {
      if (!shared_->states) shared_->states = statesOf(trajectory);
      return shared_->states;
    });
  }

 private:
  struct Shared {
    explicit Shared(Trajectory told) : trajectory(std::move(told)) {}

    std::mutex mutex;
    const Trajectory trajectory;
    const std::shared_ptr<const std::vector<double>> times =
        std::make_shared<const std::vector<double>>(trajectory.times());
    std::shared_ptr<const States> states;
  };
  std::shared_ptr<Shared> shared_;
};

/// What draws a motion.
class MotionFilm {
 public:
  MotionFilm(const Motion& motion, int width, int height, const std::string& overlay)
      : motion_(motion), film_(motion.alone([&](const Trajectory& trajectory) {
          return Film(trajectory, {width, height, overlay});
        })) {}

  ~MotionFilm() {
    const py::gil_scoped_release released;  // another film may be drawing
    film_.reset();
  }
  MotionFilm(const MotionFilm&) = delete;
  MotionFilm& operator=(const MotionFilm&) = delete;

  Picture draw(long frame) {
    return motion_.alone([&](const Trajectory&) { return film_->draw(frame); });
  }

 private:
  Motion motion_;
  std::optional<Film> film_;
};

py::array readOnly(py::array array) {
  array.attr("setflags")("write"_a = false);
  return array;
}

/// A view of numbers that `owner` keeps.
template <class Number, class Owner>
py::array viewOf(const std::shared_ptr<Owner>& owner, const Number* numbers, std::vector<std::size_t> shape) {
  const py::capsule kept(new std::shared_ptr<Owner>(owner),
                         [](void* pointer) { delete static_cast<std::shared_ptr<Owner>*>(pointer); });
  return readOnly(py::array_t<Number>(std::move(shape), numbers, kept));
}

template <std::size_t Size>
py::array viewOfBodies(const Motion& motion, std::vector<std::array<double, Size>> States::*member) {
  const auto states = motion.states();
  const double* numbers = reinterpret_cast<const double*>((*states.*member).data());
  return viewOf(states, numbers, {states->frames, states->bodies, Size});
}

py::array viewOfJoints(const Motion& motion, std::vector<double> States::*member) {
  const auto states = motion.states();
  return viewOf(states, (*states.*member).data(), {states->frames, states->joints});
}

py::array copyOf(const Vector3& vector) {
  return readOnly(py::array_t<double>(3, vector.data()));
}

/// Lets Python look for Ctrl-C now and then while this thread loads or simulates.
class SignalWatch {
 private:
  void look() {
    constexpr std::chrono::milliseconds kInterval(50);
    Busy::requireTime();
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < kInterval) return;
    last_ = now;
    const py::gil_scoped_acquire acquired;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  const Watch watch_{[this] { look(); }};
};

void warn(const std::string& warning) {
  const py::gil_scoped_acquire acquired;
  if (PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 2)  // where simulate() is called from
      != 0)
    throw py::error_already_set();
}

Motion simulateScene(const Scene& scene, const std::function<void(double, double)>& progress) {
  for (const std::string& warning : scene.warnings()) warn(warning);
  const Busy busy;
  const py::gil_scoped_release released;
  const SignalWatch signals;
  const auto tell = [&](double time) {
    if (!progress) return;
    const py::gil_scoped_acquire acquired;
    progress(time, scene.duration());
  };
  Callbacks callbacks;
  callbacks.frame = [&](const Frame& frame) { tell(frame.time); };
  callbacks.warning = warn;
  callbacks.reached = tell;
  return Motion(simulate(scene, callbacks));
}

py::array arrayOf(const Picture& picture) {
  return py::array_t<std::uint8_t>({picture.height, picture.width, 3}, picture.pixels.data());
}

/// Copies of what does not change.
py::object sameOf(const py::object& self) {
  return self;
}

py::object sameOfDeep(const py::object& self, const py::dict& /*memo*/) {
  return self;
}

const char* nameOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return "usage";
    case ErrorKind::scene:
      return "scene";
    case ErrorKind::mesh:
      return "mesh";
    case ErrorKind::output:
      return "output";
    case ErrorKind::unstable:
      return "unstable";
    case ErrorKind::limit:
      return "limit";
  }
  return "";
}

const char* nameOf(cradle::v1::Motion motion) {
  switch (motion) {
    case cradle::v1::Motion::dynamic:
      return "dynamic";
    case cradle::v1::Motion::fixed:
      return "static";
    case cradle::v1::Motion::driven:
      return "driven";
  }
  return "";
}

void addErrors(py::module_& module) {
  static const py::exception<Error> error(module, "Error");
  error.attr("kind") = "";
  error.doc() = "What the caller can mend; `kind` is usage, scene, mesh, output, unstable or limit.";
  static const py::exception<FailedCheck> failedCheck(module, "FailedCheck", PyExc_AssertionError);
  failedCheck.doc() = "A check inside Cradle that failed: a bug in Cradle.";
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(std::move(thrown));
    } catch (const Error& caught) {
      py::object instance = py::handle(error.ptr())(caught.what());
      instance.attr("kind") = nameOf(caught.kind());
      PyErr_SetObject(error.ptr(), instance.ptr());
    } catch (const FailedCheck& caught) {
      PyErr_SetString(failedCheck.ptr(), caught.what());
    }
  });
}

void addScene(py::module_& module) {
  py::class_<Body>(module, "Body", "A body as the scene places it (SI units).")
      .def("__copy__", sameOf)
      .def("__deepcopy__", sameOfDeep, "memo"_a)
      .def_readonly("name", &Body::name)
      .def_property_readonly(
          "motion", [](const Body& body) { return nameOf(body.motion); }, "dynamic, static or driven")
      .def_readonly("mass", &Body::mass, "kg; 0 unless dynamic")
      .def_property_readonly(
          "center_of_mass", [](const Body& body) { return copyOf(body.centerOfMass); }, "m, body's frame")
      .def_property_readonly(
          "inertia_tensor",
          [](const Body& body) {
            return readOnly(py::array_t<double>({3, 3}, body.inertiaTensor[0].data()));
          },
          "kg m^2, about the centre of mass, axes of the body's frame")
      .def_property_readonly(
          "position", [](const Body& body) { return copyOf(body.position); },
          "m, world, of the center of mass at the start")
      .def_property_readonly(
          "orientation", [](const Body& body) { return readOnly(py::array_t<double>(4, body.orientation.data())); },
          "worldFromBody as w, x, y, z, at the start")
      .def_property_readonly(
          "linear_velocity", [](const Body& body) { return copyOf(body.linearVelocity); }, "m/s, at the start")
      .def_property_readonly(
          "angular_velocity", [](const Body& body) { return copyOf(body.angularVelocity); },
          "rad/s, world, at the start")
      .def("__repr__", [](const Body& body) { return "<cradle.Body " + body.name + ">"; });
  py::class_<Scene>(module, "Scene", "A scene: checked, its meshes read and their mass properties computed.")
      .def("__copy__", sameOf)
      .def("__deepcopy__", sameOfDeep, "memo"_a)
      .def_static(
          "load", [](const std::filesystem::path& path) { return Scene::load(path.string()); }, "path"_a,
          py::call_guard<py::gil_scoped_release, SignalWatch>())
      .def_static("parse", &Scene::parse, "text"_a, "path"_a = "scene.json",
                  py::call_guard<py::gil_scoped_release, SignalWatch>())
      .def_property_readonly("name", &Scene::name)
      .def_property_readonly("text", &Scene::text)
      .def_property_readonly("duration", &Scene::duration, "s")
      .def_property_readonly("frame_count", &Scene::frameCount)
      .def_property_readonly("bodies", &Scene::bodies)
      .def_property_readonly("warnings", &Scene::warnings, "What the user should know about it that is no error.")
      .def("__repr__", [](const Scene& scene) { return "<cradle.Scene " + scene.name() + ">"; });
}

void addEvent(py::module_& module) {
  py::class_<Event>(module, "Event", "An impact, or another change of the motion between frames.")
      .def("__copy__", sameOf)
      .def("__deepcopy__", sameOfDeep, "memo"_a)
      .def_readonly("time", &Event::time, "s")
      .def_readonly("kind", &Event::kind)
      .def_readonly("body_a", &Event::bodyA, "index into all_bodies")
      .def_readonly("body_b", &Event::bodyB, "index into all_bodies; -1: the world")
      .def_property_readonly(
          "point", [](const Event& event) { return copyOf(event.point); }, "m, world")
      .def_property_readonly(
          "normal", [](const Event& event) { return copyOf(event.normal); }, "unit, from A to B")
      .def_readonly("impulse", &Event::impulse, "N s")
      .def("__repr__", [](const Event& event) {
        return py::str("<cradle.Event {} of bodies {} and {} at {:.6g} s>")
            .format(event.kind, event.bodyA, event.bodyB, event.time);
      });
  py::class_<ContactForce>(module, "ContactForce", "What body A does to body B by a contact that lasts.")
      .def("__copy__", sameOf)
      .def("__deepcopy__", sameOfDeep, "memo"_a)
      .def_readonly("contact", &ContactForce::contact)
      .def_readonly("body_a", &ContactForce::bodyA)
      .def_readonly("body_b", &ContactForce::bodyB)
      .def_property_readonly(
          "force", [](const ContactForce& force) { return copyOf(force.force); }, "N, world, on B")
      .def_property_readonly(
          "normal_force", [](const ContactForce& force) { return copyOf(force.normalForce); }, "N")
      .def_property_readonly(
          "torque", [](const ContactForce& force) { return copyOf(force.torque); }, "N m, about point")
      .def_property_readonly(
          "point", [](const ContactForce& force) { return copyOf(force.point); }, "m, world")
      .def("__repr__", [](const ContactForce& force) {
        return py::str("<cradle.ContactForce {} of body {} on body {}>")
            .format(copyOf(force.force), force.bodyA, force.bodyB);
      });
}

void addTrajectory(py::module_& module) {
  PYBIND11_NUMPY_DTYPE_EX(EnergyBalance, kinetic, "kinetic", potential, "potential", dissipated, "dissipated", impact,
                          "impact", friction, "friction", damping, "damping", numerical, "numerical", work, "work",
                          momentum, "momentum", angularMomentum, "angular_momentum");
  py::class_<Motion>(module, "Trajectory", "A motion: states at frames, events between them, energies.")
      .def("__copy__", sameOf)
      .def("__deepcopy__", sameOfDeep, "memo"_a)
      .def(py::init([](const std::filesystem::path& path) { return Motion(Trajectory::open(path.string())); }),
           "path"_a)
      .def(py::init<const Motion&>(), "other"_a)
      .def_property_readonly(
          "times",
          [](const Motion& motion) { return viewOf(motion.times(), motion.times()->data(), {motion.times()->size()}); },
          "s: (frames)")
      .def_property_readonly(
          "positions", [](const Motion& motion) { return viewOfBodies(motion, &States::positions); },
          "m, of centres of mass, world: (frames, bodies, 3)")
      .def_property_readonly(
          "orientations", [](const Motion& motion) { return viewOfBodies(motion, &States::orientations); },
          "worldFromBody as w, x, y, z: (frames, bodies, 4)")
      .def_property_readonly(
          "linear_velocities", [](const Motion& motion) { return viewOfBodies(motion, &States::linearVelocities); },
          "m/s: (frames, bodies, 3)")
      .def_property_readonly(
          "angular_velocities", [](const Motion& motion) { return viewOfBodies(motion, &States::angularVelocities); },
          "rad/s, world: (frames, bodies, 3)")
      .def_property_readonly(
          "joint_coordinates", [](const Motion& motion) { return viewOfJoints(motion, &States::coordinates); },
          "rad or m: (frames, joints)")
      .def_property_readonly(
          "joint_velocities", [](const Motion& motion) { return viewOfJoints(motion, &States::velocities); },
          "rad/s or m/s: (frames, joints)")
      .def_property_readonly(
          "joint_forces", [](const Motion& motion) { return viewOfJoints(motion, &States::forces); },
          "N m or N, of motors: (frames, joints)")
      .def_property_readonly(
          "energy",
          [](const Motion& motion) {
            const auto states = motion.states();
            return viewOf(states, states->energy.data(), {states->frames});
          },
          "J, kg m/s, kg m^2/s: (frames), with the fields kinetic, potential, dissipated, impact, friction, damping, "
          "numerical, work, momentum, angular_momentum")
      .def_property_readonly(
          "events",
          [](const Motion& motion) { return motion.alone([](const Trajectory& told) { return told.events(); }); },
          "in the order of time")
      .def(
          "contacts",
          [](const Motion& motion, long frame) {
            return motion.alone([frame](const Trajectory& told) { return told.frame(frame).contacts; });
          },
          "frame"_a, "What lasting contacts do at a frame.")
      .def_property_readonly(
          "all_bodies",
          [](const Motion& motion) { return motion.alone([](const Trajectory& told) { return told.bodies(); }); },
          "names of all bodies")
      .def_property_readonly(
          "moving_bodies",
          [](const Motion& motion) { return motion.alone([](const Trajectory& told) { return told.movingBodies(); }); },
          "indices into all_bodies of those that have states")
      .def_property_readonly(
          "joints",
          [](const Motion& motion) { return motion.alone([](const Trajectory& told) { return told.joints(); }); },
          "names of hinges, then sliders")
      .def_property_readonly(
          "horizon",
          [](const Motion& motion) { return motion.alone([](const Trajectory& told) { return told.horizon(); }); },
          "s: from there on the motion is one of many, if that was found")
      .def_property_readonly(
          "meta", [](const Motion& motion) { return motion.alone([](const Trajectory& told) { return told.meta(); }); },
          "version, method, promise and more")
      .def_property_readonly(
          "scene_text",
          [](const Motion& motion) { return motion.alone([](const Trajectory& told) { return told.sceneText(); }); })
      .def(
          "save",
          [](const Motion& motion, const std::filesystem::path& path) {
            motion.alone([&path](const Trajectory& told) { told.save(path.string()); });
          },
          "path"_a, "Writes a trajectory file.")
      .def(
          "player_page",
          [](const Motion& motion) { return motion.alone([](const Trajectory& told) { return playerPage(told); }); },
          "A page (HTML) that plays it and needs nothing else.");
}

void addFilm(py::module_& module) {
  py::class_<MotionFilm>(module, "Film",
                         "Draws pictures of a trajectory: (width, height) pixels, by default the scene's.")
      .def(py::init([](const Motion& motion, std::optional<std::array<int, 2>> size, const std::string& overlay) {
             if (size && ((*size)[0] == 0 || (*size)[1] == 0))
               throw Error(ErrorKind::usage, "size: found 0; allowed are 1 to 16384 pixels");
             const auto [width, height] = size.value_or(std::array<int, 2>{0, 0});
             return std::make_unique<MotionFilm>(motion, width, height, overlay);
           }),
           "trajectory"_a, "size"_a = py::none(), "overlay"_a = "")
      .def(
          "draw", [](MotionFilm& film, long frame) { return arrayOf(film.draw(frame)); }, "frame"_a,
          "The picture of a frame: (height, width, 3) of uint8, sRGB.");
}

}  // namespace

PYBIND11_MODULE(_cradle, module) {
  module.doc() = "Rigid-body physics from a scene file, and pictures of it.";
  addErrors(module);
  addScene(module);
  addEvent(module);
  addTrajectory(module);
  addFilm(module);
  module.def("simulate", &simulateScene, "scene"_a, "progress"_a = nullptr);
  module.def("_await_others", &Busy::awaitOthers);
  module.attr("__version__") = CRADLE_VERSION;
}
