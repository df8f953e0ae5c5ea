// MuJoCo's own renderer, off-screen through EGL: depth and ids of the bodies of each frame, for ground_truth_peers.py.
//
//     mujoco_ground_truth MODEL.xml POSES FRAMES FOLDER
//
// POSES has, frame by frame, position (m) and orientation (w, x, y, z) of each mocap body of the model, as float64. The
// view is that of the model's first camera, of the model's off-screen size. FOLDER, which must be there, gets
// depth_NUMBER.f32 (m along the view, infinite where nothing is) and ids_NUMBER.u16 (0: nothing; n + 1: geom n of the
// model), row 0 on top. The CPU milliseconds a frame are printed, without the first frame, which compiles shaders.

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

constexpr int kNumbersOfPose = 7;
constexpr int kMostGeoms = 1000;  // that a picture can have

/// Both buffers of a picture, as files have them.
struct Passes {
  std::vector<float> depth;        // m
  std::vector<std::uint16_t> ids;  // 0: nothing
};

double cpuSeconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <class Number>
std::vector<Number> numbersOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw std::runtime_error(path + " cannot be read");
  std::vector<Number> numbers(static_cast<std::size_t>(file.tellg()) / sizeof(Number));
  file.seekg(0).read(reinterpret_cast<char*>(numbers.data()),
                     static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
  return numbers;
}

template <class Number>
void writeNumbers(const std::vector<Number>& numbers, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(Number)));
  if (!file.flush()) throw std::runtime_error(path + " cannot be written");
}

/// A context without a window; of OpenGL's old profile, which MuJoCo draws by. It lasts until the process ends.
void openContext() {
  const EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE ||
      eglBindAPI(EGL_OPENGL_API) != EGL_TRUE)
    throw std::runtime_error("EGL has no display without a screen; install libgl1-mesa-dri");
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, nullptr);
  if (context == EGL_NO_CONTEXT || eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != EGL_TRUE)
    throw std::runtime_error("EGL gives no context of OpenGL");
}

/// What MuJoCo draws a model by. As it lasts until the process ends, nothing of it is freed.
class Renderer {
 public:
  explicit Renderer(const std::string& modelPath);

  int bodies() const { return model_->nmocap; }

  /// `poses`: of all mocap bodies.
  void place(const double* poses);
  void drawInto(Passes& passes);

 private:
  std::vector<std::uint16_t> idsOfSegments() const;

  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
  mjvScene scene_{};
  mjvOption option_{};
  mjvCamera camera_{};
  mjrContext context_{};
  mjrRect picture_{};
  double near_ = 0, far_ = 0;           // m, between them there is depth
  std::vector<float> buffer_;           // depth as OpenGL has it, 0 to 1, the lowest row first
  std::vector<std::uint8_t> segments_;  // numbers of segments as red + 256 green + 65536 blue
};

Renderer::Renderer(const std::string& modelPath) {
  std::array<char, 1000> fault{};
  model_ = mj_loadXML(modelPath.c_str(), nullptr, fault.data(), static_cast<int>(fault.size()));
  if (model_ == nullptr) throw std::runtime_error(fault.data());
  data_ = mj_makeData(model_);
  near_ = static_cast<double>(model_->vis.map.znear) * model_->stat.extent;
  far_ = static_cast<double>(model_->vis.map.zfar) * model_->stat.extent;
  picture_ = {0, 0, model_->vis.global.offwidth, model_->vis.global.offheight};
  const std::size_t pixels = static_cast<std::size_t>(picture_.width * picture_.height);
  buffer_.resize(pixels);
  segments_.resize(3 * pixels);

  mjv_defaultOption(&option_);
  mjv_defaultCamera(&camera_);
  camera_.type = mjCAMERA_FIXED;
  camera_.fixedcamid = 0;
  mjv_defaultScene(&scene_);
  mjv_makeScene(model_, &scene_, kMostGeoms);
  scene_.flags[mjRND_SEGMENT] = scene_.flags[mjRND_IDCOLOR] = 1;
  mjr_defaultContext(&context_);
  mjr_makeContext(model_, &context_, mjFONTSCALE_100);
  mjr_setBuffer(mjFB_OFFSCREEN, &context_);
  if (context_.currentBuffer != mjFB_OFFSCREEN) throw std::runtime_error("MuJoCo has no off-screen buffer");
}

void Renderer::place(const double* poses) {
  for (int body = 0; body < bodies(); ++body, poses += kNumbersOfPose) {
    std::copy_n(poses, 3, data_->mocap_pos + 3 * body);
    std::copy_n(poses + 3, 4, data_->mocap_quat + 4 * body);
  }
  mj_kinematics(model_, data_);
  mj_camlight(model_, data_);
}

/// By number of segment: the geom's number + 1.
std::vector<std::uint16_t> Renderer::idsOfSegments() const {
  std::vector<std::uint16_t> ids(static_cast<std::size_t>(scene_.ngeom) + 1, 0);
  for (int i = 0; i < scene_.ngeom; ++i) {
    const mjvGeom& geom = scene_.geoms[i];
    if (geom.objtype == mjOBJ_GEOM && geom.segid >= 0)
      ids.at(static_cast<std::size_t>(geom.segid) + 1) = static_cast<std::uint16_t>(geom.objid + 1);
  }
  return ids;
}

/// The buffer of a perspective has b = far (z - near) / (z (far - near)) of the depth z.
void Renderer::drawInto(Passes& passes) {
  mjv_updateScene(model_, data_, &option_, nullptr, &camera_, mjCAT_ALL, &scene_);
  mjr_render(picture_, &scene_, &context_);
  mjr_readPixels(segments_.data(), buffer_.data(), picture_, &context_);

  const std::vector<std::uint16_t> ids = idsOfSegments();
  const std::size_t width = static_cast<std::size_t>(picture_.width), rows = static_cast<std::size_t>(picture_.height);
  passes.depth.resize(buffer_.size());
  passes.ids.resize(buffer_.size());
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < width; ++column) {
      const std::size_t from = (rows - 1 - row) * width + column, to = row * width + column;
      const std::uint8_t* segment = &segments_[3 * from];
      const double depth = near_ / (1 - static_cast<double>(buffer_[from]) * (1 - near_ / far_));
      passes.ids[to] = ids.at(segment[0] + 256U * segment[1] + 65536U * segment[2]);
      passes.depth[to] = passes.ids[to] == 0 ? std::numeric_limits<float>::infinity() : static_cast<float>(depth);
    }
}

void renderFilm(const std::string& modelPath, const std::string& posesPath, int frames, const std::string& folder) {
  openContext();
  Renderer renderer(modelPath);
  const std::vector<double> poses = numbersOf<double>(posesPath);
  const std::size_t numbersOfFrame = static_cast<std::size_t>(kNumbersOfPose * renderer.bodies());
  if (poses.size() < numbersOfFrame * static_cast<std::size_t>(frames))
    throw std::runtime_error(posesPath + " has fewer frames");

  Passes passes;
  double start = 0;  // s of CPU time
  for (int frame = 0; frame < frames; ++frame) {
    renderer.place(&poses[numbersOfFrame * static_cast<std::size_t>(frame)]);
    renderer.drawInto(passes);
    writeNumbers(passes.depth, fmt::format("{}/depth_{:06}.f32", folder, frame));
    writeNumbers(passes.ids, fmt::format("{}/ids_{:06}.u16", folder, frame));
    if (frame == 0) start = cpuSeconds();
  }
  if (frames > 1) fmt::print("{:.3f} CPU ms a frame\n", 1e3 * (cpuSeconds() - start) / (frames - 1));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 5) {
    fmt::print(stderr, "usage: mujoco_ground_truth MODEL.xml POSES FRAMES FOLDER\n");
    return 2;
  }
  try {
    renderFilm(arguments[1], arguments[2], std::atoi(arguments[3]), arguments[4]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mujoco_ground_truth: {}\n", error.what());
    return 1;
  }
}
