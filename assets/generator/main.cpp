// Writes the models of this folder, or checks that the files there are what would be written.

#include <cstdio>
#include <fstream>
#include <iterator>

#include "die.h"
#include "file_3ds.h"
#include "image/png.h"
#include "models.h"

namespace {

bool hasBytes(const std::string& path, const std::string& bytes) {
  std::ifstream stream(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(stream), {}) == bytes;
}

bool write(const std::string& path, const std::string& bytes) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return static_cast<bool>(stream.flush());
}

}  // namespace

int main(int argumentCount, char** arguments) {
  const bool onlyChecks = argumentCount == 3 && std::string(arguments[1]) == "--check";
  if (argumentCount != 2 && !onlyChecks) {
    std::fprintf(stderr, "usage: generate_assets [--check] FOLDER\n");
    return 2;
  }
  const std::string folder = arguments[argumentCount - 1];
  bool allGood = true;
  const auto take = [&](const std::string& fileName, const std::string& bytes) {
    const std::string path = folder + "/" + fileName;
    const bool good = onlyChecks ? hasBytes(path, bytes) : write(path, bytes);
    if (!good) std::fprintf(stderr, "%s: %s\n", path.c_str(), onlyChecks ? "differs: generate again" : "not written");
    allGood = allGood && good;
  };
  for (const cradle::assets::Model& model : cradle::assets::allModels()) take(model.fileName, encode3ds(model));
  const std::vector<std::uint8_t> picture = cradle::encodePng(cradle::assets::diePicture());
  take("die.png", {picture.begin(), picture.end()});
  return allGood ? 0 : 1;
}
