// CPU time of a picture of 1000 and of 10 000 bodies, balls and boxes that all move, drawn whole and drawn as changes
// of the one before, against the cradle's drawn whole (1280x720): medians of pictures drawn in turns, and the peak of
// memory.

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <memory>
#include <vector>

#include "render/demo_scenes.h"
#include "render/renderer.h"

namespace cradle {
namespace {

constexpr int kWidth = 1280, kHeight = 720;
constexpr int kPictures = 11;
constexpr double kStep = 1e-3;  // m that every body moves from picture to picture

/// A heap in flight: `count` bodies in a lattice over the ground, every other one a box.
Scene makeCrowd(int count) {
  Scene scene = makeCradleScene();  // for its materials, ground and light
  scene.bodies.resize(1);
  scene.rods.clear();
  const int edge = static_cast<int>(std::ceil(std::cbrt(count)));
  for (int i = 0; i < count; ++i) {
    Body body;
    if (i % 2 == 0)
      body.shape = Sphere{0.1};
    else
      body.shape = Box{{0.18, 0.18, 0.18}};
    body.material = 1 + i % 6;
    body.motion = Motion::dynamic;
    body.massProperties.mass = 1;
    body.massProperties.inertiaTensor = Mat3::Identity();
    body.worldFromBody = {Quat(Eigen::AngleAxisd(i, Vec3(1, 2, 3).normalized())),
                          0.25 * Vec3(i % edge, i / (edge * edge), i / edge % edge) + Vec3(0, 0.2, 0)};
    scene.bodies.push_back(body);
  }
  return scene;
}

double cpuSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// A scene that is drawn again and again, each time with all bodies a little further.
class Film {
 public:
  explicit Film(Scene scene) : scene_(std::move(scene)), frame_(startFrame(scene_)) {
    Framing framing(scene_, kWidth, kHeight);
    framing.add(frame_);
    renderer_ = std::make_unique<Renderer>(scene_, framing.view(), kWidth, kHeight);
    renderer_->render(frame_);  // compiles shaders
  }

  void draw() {
    changes_.push_back(secondsOfPicture());
    renderer_->forgetPicture();
    whole_.push_back(secondsOfPicture());
  }

  double medianWhole() const { return median(whole_); }
  double medianOfChanges() const { return median(changes_); }

 private:
  double secondsOfPicture() {
    for (BodyState& state : frame_.states) state.position.y() += kStep;
    const double start = cpuSeconds();
    renderer_->render(frame_);
    return cpuSeconds() - start;
  }

  static double median(std::vector<double> seconds) {
    std::nth_element(seconds.begin(), seconds.begin() + kPictures / 2, seconds.end());
    return seconds[kPictures / 2];
  }

  Scene scene_;
  Frame frame_;
  std::unique_ptr<Renderer> renderer_;
  std::vector<double> whole_, changes_;  // s of CPU time
};

void run() {
  Film cradle(makeCradleScene()), thousand(makeCrowd(1000)), tenThousand(makeCrowd(10000));
  for (int i = 0; i < kPictures; ++i)
    for (Film* film : {&cradle, &thousand, &tenThousand}) film->draw();
  const double unit = cradle.medianWhole();
  const auto print = [unit](const char* name, const Film& film) {
    fmt::print("{:<14} whole {:7.1f} ms, {:5.2f} of the cradle's; as changes {:7.1f} ms\n", name,
               1e3 * film.medianWhole(), film.medianWhole() / unit, 1e3 * film.medianOfChanges());
  };
  print("cradle", cradle);
  print("1000 bodies", thousand);
  print("10 000 bodies", tenThousand);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("peak of memory, all three: {} MB\n", usage.ru_maxrss / 1024);
}

}  // namespace
}  // namespace cradle

int main() {
  cradle::run();
}
