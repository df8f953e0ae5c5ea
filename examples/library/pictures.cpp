// pictures SCENE TRAJECTORY PICTURE.ppm: simulates a scene file, saves the trajectory, and draws its last frame.
#include <cradle/render.h>
#include <cradle/simulate.h>

#include <cstdio>
#include <fstream>

int main(int argc, char** argv) {
  namespace cr = cradle::v1;
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s SCENE TRAJECTORY PICTURE.ppm\n", argv[0]);
    return 2;
  }
  try {
    const cr::Trajectory motion = cr::simulate(cr::Scene::load(argv[1]));
    motion.save(argv[2]);
    const cr::Picture picture = cr::Film(motion, {.overlay = "time"}).draw(motion.frameCount() - 1);
    std::ofstream file(argv[3], std::ios::binary);
    file << "P6 " << picture.width << " " << picture.height << " 255\n";
    file.write(reinterpret_cast<const char*>(picture.pixels.data()),
               static_cast<std::streamsize>(picture.pixels.size()));
    return file.good() ? 0 : 5;
  } catch (const cr::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.kind());
  }
}
