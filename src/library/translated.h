#pragma once

#include <cradle/error.h>

#include "core/error.h"

namespace cradle::v1 {

/// Calls `work`; what Cradle throws inside is thrown as what the library promises.
template <class Work>
auto translated(const Work& work) {
  try {
    return work();
  } catch (const cradle::Error& error) {
    throw Error(static_cast<ErrorKind>(error.kind()), error.what());
  } catch (const cradle::FailedCheck& bug) {
    throw FailedCheck(bug.what());
  }
}

}  // namespace cradle::v1
