#include <cradle/watch.h>

#include "core/interruption.h"
#include "library/translated.h"

namespace cradle::v1 {

struct Watch::Content {
  explicit Content(const std::function<void()>& look) : watch([look] { asThrownByCaller(look); }) {}

  InterruptionWatch watch;
};

Watch::Watch(std::function<void()> look) : content_(std::make_unique<Content>(look)) {}

Watch::~Watch() = default;

}  // namespace cradle::v1
