#pragma once

#include <string>
#include <vector>

namespace cradle {

/// Tells a warning on stderr.
void warn(const std::string& warning);

/// The first of them, and how many more there are: a file may give rise to a million.
void warnOfAll(const std::vector<std::string>& warnings);

/// Takes the warnings of this process while it lives, in place of stderr. There is one at a time.
class CollectedWarnings {
 public:
  CollectedWarnings();
  ~CollectedWarnings();
  CollectedWarnings(const CollectedWarnings&) = delete;
  CollectedWarnings& operator=(const CollectedWarnings&) = delete;

  const std::vector<std::string>& texts() const { return texts_; }

 private:
  std::vector<std::string> texts_;
};

/// No warning is told from now on. Trajectories keep theirs, and errors are told as ever.
void silenceWarnings();

}  // namespace cradle
