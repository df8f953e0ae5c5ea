// A library to preload into a program (LD_PRELOAD): some calls of one kind fail, as with a full or broken disk, too
// many open files, or no memory. Calls are counted from main on, over all processes that the program forks (the count
// is in a file that they share), but not in programs that it starts. The environment says which fail:
//
//   FAILING_KIND            write, sync, truncate, rename, unlink, close, open or memory
//   FAILING_ERROR           errno of the failure; 0 with write: half of the bytes are written
//   FAILING_FIRST, _LAST    numbers of the first and the last call that fails, from 1; 0: none fails
//   FAILING_FOLDER          calls for files below it, by whole paths, count, and those for devices and pipes
//   FAILING_REPORT          file that says afterwards how many calls of each kind there were, which one failed (of
//                           several the last), and in which process
//
// Of memory those requests count that come from the program's own code (templates of the standard library are part of
// it): libraries have failures of their own. Nor do those count that libraries make while they are loaded, by templates
// of the standard library that they share with the program. stdio is left out save its fopen: its other calls stay
// inside of libc.

#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <sys/mman.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string_view>
#include <utility>

// The allocator of libc by its own names: dlsym itself asks for memory.
extern "C" void* __libc_malloc(std::size_t) noexcept;
extern "C" void* __libc_calloc(std::size_t, std::size_t) noexcept;
extern "C" void* __libc_realloc(void*, std::size_t) noexcept;
extern "C" void* __libc_memalign(std::size_t, std::size_t) noexcept;

namespace {

enum class Kind { write, sync, truncate, rename, unlink, close, open, memory };
constexpr std::array<std::string_view, 8> kKindNames{"write",  "sync",  "truncate", "rename",
                                                     "unlink", "close", "open",     "memory"};

/// The file FAILING_REPORT, as failing_calls_test.py reads it.
struct Report {
  std::array<std::atomic<std::uint64_t>, kKindNames.size()> calls;
  std::int64_t process;
  std::array<char, 952> call;
};
static_assert(sizeof(Report) == 1024);

struct Choice {
  std::string_view kind, folder;
  int error = 0;
  std::uint64_t first = 0, last = 0;
  std::uintptr_t codeBegin = 0, codeEnd = 0;  // addresses of the program's own code
  Report* report = nullptr;                   // null until main
};
Choice choice;

thread_local bool isLoading = false;  // a library, in this thread

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// Counts a call. True if it is to fail.
bool isChosen(Kind kind, const char* call, const char* subject) {
  const auto index = static_cast<std::size_t>(kind);
  const std::uint64_t number = ++choice.report->calls[index];
  if (kKindNames[index] != choice.kind || number < choice.first || number > choice.last) return false;
  choice.report->process = getpid();
  std::snprintf(choice.report->call.data(), choice.report->call.size(), "%s %s", call, subject);
  return true;
}

bool isOurs(std::string_view path) {
  return path.starts_with(choice.folder) || path.starts_with("/dev/") || path.starts_with("pipe:");
}

bool failsAt(Kind kind, const char* call, const char* path) {
  return choice.report != nullptr && isOurs(path) && isChosen(kind, call, path);
}

bool failsAt(Kind kind, const char* call, int file) {
  if (choice.report == nullptr || file <= STDERR_FILENO) return false;
  std::array<char, 32> link{};
  std::array<char, PATH_MAX> path{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", file);
  const int before = errno;
  const ssize_t length = readlink(link.data(), path.data(), path.size() - 1);
  errno = before;
  return length > 0 && isOurs(path.data()) && isChosen(kind, call, path.data());
}

/// What a call of libc returns that failed.
int fail() {
  errno = choice.error;
  return -1;
}

/// `write` takes the number of bytes that are to be written.
template <class Write>
ssize_t writing(const char* call, int file, std::size_t size, const Write& write) {
  if (!failsAt(Kind::write, call, file)) return write(size);
  return choice.error == 0 ? write((size + 1) / 2) : fail();
}

bool isWithoutMemory(std::size_t size, const void* caller) {
  const auto place = reinterpret_cast<std::uintptr_t>(caller);
  if (choice.report == nullptr || isLoading || place < choice.codeBegin || place >= choice.codeEnd) return false;
  std::array<char, 80> subject{};
  std::snprintf(subject.data(), subject.size(), "of %zu bytes at %#zx of the program", size,
                static_cast<std::size_t>(place - choice.codeBegin));
  if (!isChosen(Kind::memory, "memory", subject.data())) return false;
  errno = ENOMEM;
  return true;
}

mode_t modeOf(int flags, std::va_list arguments) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

int noteProgram(dl_phdr_info* program, std::size_t /*size*/, void* /*data*/) {
  for (int i = 0; i < program->dlpi_phnum; ++i) {
    const auto& segment = program->dlpi_phdr[i];
    if (segment.p_type != PT_LOAD || (segment.p_flags & PF_X) == 0) continue;
    choice.codeBegin = program->dlpi_addr + segment.p_vaddr;
    choice.codeEnd = choice.codeBegin + segment.p_memsz;
  }
  return 1;  // the first object is the program
}

const char* setting(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

Report* openReport(const char* path) {
  const int file = open(path, O_RDWR | O_CREAT | O_TRUNC, 0666);
  if (file < 0 || ftruncate(file, sizeof(Report)) != 0) std::abort();
  void* shared = mmap(nullptr, sizeof(Report), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (shared == MAP_FAILED) std::abort();
  close(file);
  return static_cast<Report*>(shared);
}

int (*programMain)(int, char**, char**) = nullptr;

int runMain(int count, char** arguments, char** environment) {
  unsetenv("LD_PRELOAD");  // for programs that this one starts
  choice.kind = setting("FAILING_KIND"), choice.folder = setting("FAILING_FOLDER");
  choice.error = std::atoi(setting("FAILING_ERROR"));
  choice.first = std::strtoull(setting("FAILING_FIRST"), nullptr, 10);
  choice.last = std::strtoull(setting("FAILING_LAST"), nullptr, 10);
  dl_iterate_phdr(noteProgram, nullptr);
  choice.report = openReport(setting("FAILING_REPORT"));
  return programMain(count, arguments, environment);
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int count, char** arguments, void (*init)(), void (*fini)(),
                      void (*endOfLoader)(), void* stack) {
  programMain = main;
  return next<decltype(__libc_start_main)>("__libc_start_main")(runMain, count, arguments, init, fini, endOfLoader,
                                                                stack);
}

void* dlopen(const char* file, int mode) {
  static const auto libc = next<decltype(dlopen)>("dlopen");
  const bool before = std::exchange(isLoading, true);
  void* library = libc(file, mode);
  isLoading = before;
  return library;
}

ssize_t write(int file, const void* bytes, std::size_t size) {
  static const auto libc = next<decltype(write)>("write");
  return writing("write", file, size, [&](std::size_t count) { return libc(file, bytes, count); });
}

ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t place) {
  static const auto libc = next<decltype(pwrite)>("pwrite");
  return writing("pwrite", file, size, [&](std::size_t count) { return libc(file, bytes, count, place); });
}

ssize_t pwrite64(int file, const void* bytes, std::size_t size, off64_t place) {
  return pwrite(file, bytes, size, place);
}

ssize_t writev(int file, const iovec* vectors, int size) {
  static const auto libc = next<decltype(writev)>("writev");
  return writing("writev", file, static_cast<std::size_t>(size),
                 [&](std::size_t count) { return libc(file, vectors, static_cast<int>(count)); });
}

int fsync(int file) {
  static const auto libc = next<decltype(fsync)>("fsync");
  return failsAt(Kind::sync, "fsync", file) ? fail() : libc(file);
}

int fdatasync(int file) {
  static const auto libc = next<decltype(fdatasync)>("fdatasync");
  return failsAt(Kind::sync, "fdatasync", file) ? fail() : libc(file);
}

int ftruncate(int file, off_t size) noexcept {
  static const auto libc = next<int(int, off_t)>("ftruncate");
  return failsAt(Kind::truncate, "ftruncate", file) ? fail() : libc(file, size);
}

int ftruncate64(int file, off64_t size) noexcept {
  return ftruncate(file, size);
}

int rename(const char* from, const char* to) noexcept {
  static const auto libc = next<int(const char*, const char*)>("rename");
  return failsAt(Kind::rename, "rename", from) ? fail() : libc(from, to);
}

int unlink(const char* path) noexcept {
  static const auto libc = next<int(const char*)>("unlink");
  return failsAt(Kind::unlink, "unlink", path) ? fail() : libc(path);
}

int remove(const char* path) noexcept {
  static const auto libc = next<int(const char*)>("remove");
  return failsAt(Kind::unlink, "remove", path) ? fail() : libc(path);
}

int close(int file) {
  static const auto libc = next<decltype(close)>("close");
  const bool fails = failsAt(Kind::close, "close", file);
  const int result = libc(file);  // Linux closes it whatever it answers
  return fails ? fail() : result;
}

int open(const char* path, int flags, ...) {
  static const auto libc = next<decltype(open)>("open");
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return failsAt(Kind::open, "open", path) ? fail() : libc(path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return open(path, flags, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  static const auto libc = next<decltype(openat)>("openat");
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return failsAt(Kind::open, "openat", path) ? fail() : libc(folder, path, flags, mode);
}

int openat64(int folder, const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = modeOf(flags, arguments);
  va_end(arguments);
  return openat(folder, path, flags, mode);
}

std::FILE* fopen(const char* path, const char* mode) {
  static const auto libc = next<decltype(fopen)>("fopen");
  return failsAt(Kind::open, "fopen", path) ? (fail(), nullptr) : libc(path, mode);
}

std::FILE* fopen64(const char* path, const char* mode) {
  return fopen(path, mode);
}

std::FILE* tmpfile() {
  static const auto libc = next<decltype(tmpfile)>("tmpfile");
  return failsAt(Kind::open, "tmpfile", "/dev/") ? (fail(), nullptr) : libc();
}

void* malloc(std::size_t size) noexcept {
  return isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  return isWithoutMemory(count * size, __builtin_return_address(0)) ? nullptr : __libc_calloc(count, size);
}

void* realloc(void* bytes, std::size_t size) noexcept {
  return isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_realloc(bytes, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}

int posix_memalign(void** bytes, std::size_t alignment, std::size_t size) noexcept {
  *bytes = isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
  return *bytes == nullptr ? ENOMEM : 0;
}

}  // extern "C"

/// What operator new does where there is none, as the standard has it: the handler may end the program.
[[noreturn]] static void failWithoutMemory() {
  if (const std::new_handler handler = std::get_new_handler()) handler();
  throw std::bad_alloc();
}

void* operator new(std::size_t size) {
  void* bytes = isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
  if (bytes == nullptr) failWithoutMemory();
  return bytes;
}

void* operator new[](std::size_t size) {
  void* bytes = isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
  if (bytes == nullptr) failWithoutMemory();
  return bytes;
}

void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  return isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}

void* operator new[](std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  return isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}

void* operator new(std::size_t size, std::align_val_t alignment) {
  const std::size_t edge = static_cast<std::size_t>(alignment);
  void* bytes = isWithoutMemory(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(edge, size);
  if (bytes == nullptr) failWithoutMemory();
  return bytes;
}
