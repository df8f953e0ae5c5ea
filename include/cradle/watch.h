#pragma once

#include <functional>
#include <memory>

namespace cradle::v1 {

/// A way to end work that takes long. While it lives, loading and simulating in the thread that made it call `look`, up
/// to a million times a second; what `look` throws ends the work, and is thrown by it. Drawing a frame does not look.
class Watch {
 public:
  explicit Watch(std::function<void()> look);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace cradle::v1
