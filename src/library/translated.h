#pragma once

#include <cradle/error.h>

#include <cfenv>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "core/error.h"

namespace cradle::v1 {

/// While it lives, this thread rounds as all of Cradle does, whatever it did before: a program that is linked with
/// -ffast-math takes denormal numbers for 0.
class OwnRounding {
 public:
  OwnRounding() {
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~OwnRounding() { std::fesetenv(&before_); }
  OwnRounding(const OwnRounding&) = delete;
  OwnRounding& operator=(const OwnRounding&) = delete;

 private:
  std::fenv_t before_{};
};

/// What a function of the caller has thrown, on its way through Cradle.
struct ThrownByCaller {
  std::exception_ptr thrown;
};

/// Calls a function of the caller, whose exceptions translated() leaves as they are.
template <class Function, class... Arguments>
void asThrownByCaller(const Function& function, const Arguments&... arguments) {
  try {
    function(arguments...);
  } catch (...) {
    throw ThrownByCaller{std::current_exception()};
  }
}

/// Calls `work`; what Cradle throws inside is thrown as what the library promises.
template <class Work>
auto translated(const Work& work) {
  const OwnRounding own;
  try {
    return work();
  } catch (const ThrownByCaller& caller) {
    std::rethrow_exception(caller.thrown);
  } catch (const cradle::Error& error) {
    const std::string_view what = error.what();  // options of the program are arguments here
    throw Error(static_cast<ErrorKind>(error.kind()), std::string(what.substr(what.starts_with("--") ? 2 : 0)));
  } catch (const cradle::FailedCheck& bug) {
    throw FailedCheck(bug.what());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorKind::limit, "out of memory; make the scene or the picture smaller");
  } catch (const std::filesystem::filesystem_error& error) {
    throw Error(ErrorKind::output, error.path1().string() + ": cannot be reached: " + error.code().message());
  } catch (const std::system_error& error) {  // of threads
    throw Error(ErrorKind::limit, std::string("no memory or threads are left: ") + error.what());
  }
}

}  // namespace cradle::v1
