// The only unit that sees SQLite.
// Writing uses SQLite's rollback journal rather than its write-ahead log: the file alone is complete after every
// commit, and nothing stands beside it at the end. Pages are not spilled to disk inside a transaction, so the file (and
// a journal) changes only for the short time of a commit, and other programs can read it in between.

#include "trajectory/database.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/output_path.h"
#include "trajectory/trajectory.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr int kMinLength = 1'000'000;    // bytes that a text may have in any file: a .part grows while it is read
constexpr int kMaxDefinition = 100'000;  // bytes of SQL; all of ours have 2000
constexpr int kMaxSchema = 200;          // tables, indices and views of a file; ours has eight
constexpr int kLongTurn = 100'000;       // instructions of SQLite; a row of a trajectory takes less than a hundred
constexpr int kPatience = 30000;         // ms to wait for another program; queries of others seldom take longer

std::string_view bytesOrEmpty(std::span<const std::byte> bytes) {
  // SQLite takes a null pointer for null, not for zero bytes.
  return bytes.empty() ? std::string_view("")
                       : std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// The name of an existing file that is not to change, with no journal, no locks: an SQLite URI of its whole path.
std::string immutableUri(const fs::path& path) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-";
  std::string uri = "file:";
  for (const char c : path.string())
    uri += kPlain.find(c) != kPlain.npos ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return uri + "?immutable=1";
}

/// The name of a file as SQLite takes it for nothing else, neither a URI nor a database in memory.
std::string plainName(const std::string& path) {
  return (fs::path(".") / path).string();
}

fs::path journalOf(const fs::path& database) {
  return database.string() + "-journal";
}

// sqlite.org, "Database File Format", section 3: the first bytes of a rollback journal, and the last of one that names
// a super-journal.
constexpr std::array<unsigned char, 8> kJournalMark{0xd9, 0xd5, 0x05, 0xf9, 0x20, 0xa1, 0x63, 0xd7};
constexpr std::size_t kJournalHeader = 28;  // bytes

std::uint64_t bigEndianAt(std::span<const unsigned char> bytes, std::size_t place) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < 4; ++i) number = number << 8 | bytes[place + i];
  return number;
}

/// Whether a rollback journal names a super-journal, which SQLite deletes when it has taken back what the journal
/// holds. (sqlite.org, "Atomic Commit In SQLite", section 5)
bool namesSuperJournal(std::ifstream& journal) {
  std::array<unsigned char, kJournalMark.size()> end{};
  journal.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  journal.read(reinterpret_cast<char*>(end.data()), end.size());
  return journal && end == kJournalMark;
}

/// Whether SQLite would make the database of `size` bytes longer, to what a rollback journal says that it had. (section
/// 3 as above: number of pages and bytes of each, 16 and 24 bytes from the beginning; 0 bytes stand for what the
/// database has, and are never written)
bool growsDatabase(std::ifstream& journal, std::uint64_t size) {
  std::array<unsigned char, kJournalHeader> header{};
  journal.clear();
  journal.seekg(0);
  journal.read(reinterpret_cast<char*>(header.data()), header.size());
  const std::uint64_t pages = bigEndianAt(header, 16), bytes = bigEndianAt(header, 24);
  return journal && std::equal(kJournalMark.begin(), kJournalMark.end(), header.begin()) &&
         (bytes == 0 || pages * bytes > size);
}

/// Ours neither name a file, as a writer has one open, nor make one longer, as it only adds.
void requireOwnJournal(const fs::path& database, ErrorKind kind) {
  const fs::path journal = journalOf(database);
  const fs::file_status status = fs::symlink_status(journal);
  if (!fs::exists(status)) return;
  if (!fs::is_regular_file(status))
    throw Error(kind, journal.string(),
                "is none of cradle's: it is no regular file; remove it, or choose another folder");
  std::ifstream file(journal, std::ios::binary);
  std::error_code failed;
  if (namesSuperJournal(file))
    throw Error(
        kind, journal.string(),
        "is none of cradle's: it names another file, which would be deleted; remove it, or choose another folder");
  if (growsDatabase(file, fs::file_size(database, failed)))
    throw Error(kind, journal.string(),
                "is none of cradle's: it belongs to a longer file; remove it, or choose another folder");
}

/// The name of a file system for SQLite that is the system's own, but opens a database, its rollback journal and
/// nothing else, and deletes nothing else: neither a log nor a super-journal, whatever the bytes of the file and of a
/// journal ask for. (sqlite.org, "OS Interface or VFS")
const char* ownFilesOnly() {
  static sqlite3_vfs vfs = [] {
    sqlite3_vfs own = *sqlite3_vfs_find(nullptr);
    own.zName = "cradle-own-files-only";
    own.xOpen = [](sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* outFlags) {
      sqlite3_vfs* system = sqlite3_vfs_find(nullptr);
      file->pMethods = nullptr;  // there is nothing to close
      if ((flags & (SQLITE_OPEN_WAL | SQLITE_OPEN_SUPER_JOURNAL)) != 0) return SQLITE_CANTOPEN;
      return system->xOpen(system, name, file, flags, outFlags);
    };
    own.xDelete = [](sqlite3_vfs*, const char* name, int syncsFolder) {
      sqlite3_vfs* system = sqlite3_vfs_find(nullptr);
      if (!std::string_view(name).ends_with("-journal")) return SQLITE_IOERR_DELETE;
      return system->xDelete(system, name, syncsFolder);
    };
    return own;
  }();
  static const int registered = sqlite3_vfs_register(&vfs, 0);
  CRADLE_CHECK(registered == SQLITE_OK);
  return vfs.zName;
}

/// How many tables, indices and views a file defines, counted up to one more than kMaxSchema: SQLite would parse all of
/// them before its first query. (sqlite.org, "Database File Format", section 1.6: the tree of the schema begins on page
/// 1, behind the header of the file; a page of type 13 has rows, one of type 5 has pages below it)
int schemaRows(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<unsigned char, 2> sizeOfPage{};
  file.seekg(16).read(reinterpret_cast<char*>(sizeOfPage.data()), sizeOfPage.size());
  const std::size_t given = std::size_t{sizeOfPage[0]} << 8 | sizeOfPage[1];
  std::vector<unsigned char> page(given == 1 ? 65536 : std::max<std::size_t>(given, 512));
  std::vector<std::uint64_t> left{1};
  int rows = 0;
  for (int seen = 0; !left.empty() && rows <= kMaxSchema; ++seen) {
    if (seen > kMaxSchema) return kMaxSchema + 1;
    const std::uint64_t number = left.back();
    left.pop_back();
    file.seekg(static_cast<std::streamoff>((number - 1) * page.size()));
    if (number == 0 || !file.read(reinterpret_cast<char*>(page.data()), std::ssize(page))) break;  // SQLite tells it
    const std::size_t start = number == 1 ? 100 : 0, cells = std::size_t{page[start + 3]} << 8 | page[start + 4];
    if (page[start] == 13) rows += static_cast<int>(std::min<std::size_t>(cells, kMaxSchema + 1));
    if (page[start] != 5) continue;
    left.push_back(bigEndianAt(page, start + 8));
    for (std::size_t at = start + 12; at < std::min(start + 12 + 2 * cells, page.size() - 1); at += 2) {
      const std::size_t cell = std::size_t{page[at]} << 8 | page[at + 1];
      if (cell + 4 <= page.size()) left.push_back(bigEndianAt(page, cell));
    }
  }
  return std::min(rows, kMaxSchema + 1);
}

/// Of its texts and blobs, and one for itself.
std::int64_t bytesOfRow(sqlite3_stmt* statement) {
  std::int64_t bytes = 1;
  for (int column = 0; column < sqlite3_column_count(statement); ++column) {
    const int type = sqlite3_column_type(statement, column);
    if (type == SQLITE_TEXT || type == SQLITE_BLOB) bytes += sqlite3_column_bytes(statement, column);
  }
  return bytes;
}

}  // namespace

void Statement::Finalize::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

void Statement::check(int code) const {
  if (code != SQLITE_OK) database_->fail(code);
}

void Statement::bindInteger(int parameter, std::int64_t value) {
  check(sqlite3_bind_int64(statement_.get(), parameter, value));
}

void Statement::bind(int parameter, double value) {
  CRADLE_CHECK(!std::isnan(value));
  check(sqlite3_bind_double(statement_.get(), parameter, value));
}

void Statement::bind(int parameter, const std::string& value) {
  check(sqlite3_bind_text64(statement_.get(), parameter, value.data(), value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
}

void Statement::bind(int parameter, std::span<const std::byte> value) {
  const std::string_view bytes = bytesOrEmpty(value);
  check(sqlite3_bind_blob64(statement_.get(), parameter, bytes.data(), bytes.size(), SQLITE_STATIC));
}

void Statement::bindNull(int parameter) {
  check(sqlite3_bind_null(statement_.get(), parameter));
}

bool Statement::step() {
  database_->beginWork();
  const int code = sqlite3_step(statement_.get());
  if (code != SQLITE_ROW && code != SQLITE_DONE) database_->fail(code);
  if (code == SQLITE_ROW) database_->requireHeld(bytesGiven_ += bytesOfRow(statement_.get()));
  return code == SQLITE_ROW;
}

void Statement::run() {
  CRADLE_CHECK(!step());
  reset();
}

void Statement::reset() {
  bytesGiven_ = 0;
  sqlite3_reset(statement_.get());  // its result repeats the last step's, which has been reported
}

bool Statement::isNull(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

void Statement::requireType(int column, int type, const char* typeName) const {
  if (sqlite3_column_type(statement_.get(), column) != type)
    database_->failDamaged(fmt::format("its column {} holds something other than {}",
                                       sqlite3_column_name(statement_.get(), column), typeName));
}

std::int64_t Statement::integer(int column) const {
  requireType(column, SQLITE_INTEGER, "an integer");
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::real(int column) const {
  // Who writes 0 for 0.0 by hand has an integer there: columns of numbers have no type that would turn it.
  if (sqlite3_column_type(statement_.get(), column) != SQLITE_INTEGER) requireType(column, SQLITE_FLOAT, "a number");
  const double value = sqlite3_column_double(statement_.get(), column);
  if (!(std::abs(value) < kLargestNumber))
    database_->failDamaged(fmt::format("its column {} holds a number that is not finite and below {:.0e}",
                                       sqlite3_column_name(statement_.get(), column), kLargestNumber));
  return value;
}

std::string Statement::text(int column) const {
  requireType(column, SQLITE_TEXT, "text");
  return anyAsText(column);
}

std::string Statement::anyAsText(int column) const {
  const auto* characters = reinterpret_cast<const char*>(sqlite3_column_text(statement_.get(), column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return characters == nullptr ? std::string() : std::string(characters, size);
}

std::span<const std::byte> Statement::blob(int column) const {
  requireType(column, SQLITE_BLOB, "a blob");
  const auto* bytes = static_cast<const std::byte*>(sqlite3_column_blob(statement_.get(), column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column));
  return bytes == nullptr ? std::span<const std::byte>() : std::span(bytes, size);
}

void Database::Close::operator()(sqlite3* handle) const {
  sqlite3_close_v2(handle);
}

Database::Database(const std::string& path, DatabaseAccess access) : path_(path), access_(access) {
  if (access == DatabaseAccess::create) {
    open(plainName(path), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    execute("PRAGMA journal_mode = DELETE; PRAGMA cache_spill = OFF; PRAGMA synchronous = NORMAL");
    return;
  }
  if (access == DatabaseAccess::extend) {
    open(plainName(path), SQLITE_OPEN_READWRITE);
    execute("PRAGMA cache_spill = OFF; PRAGMA synchronous = NORMAL");
    return;
  }
  if (access == DatabaseAccess::unnamed) {
    std::error_code failed;
    path_ = fs::temp_directory_path(failed).string();
    if (failed)
      throw Error(ErrorKind::output, "TMPDIR",
                  "names no folder, and a scene is simulated into a file there: make it, or name another");
    open("", SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
    execute("PRAGMA journal_mode = MEMORY; PRAGMA synchronous = OFF");
    return;
  }
  std::error_code failed;
  const fs::path file = fs::canonical(path, failed);
  if (failed) failReading(SQLITE_CANTOPEN);
  if (!isPartPath(file.string())) {
    open(immutableUri(file), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
  } else if (fs::exists(journalOf(file))) {
    requireOwnJournal(file, ErrorKind::usage);
    open(file.string(), SQLITE_OPEN_READWRITE);
  } else {
    open(file.string(), SQLITE_OPEN_READONLY);
  }
  restrictReading();
}

/// The file may come from anywhere: what it holds is data, never something to be run, neither views nor tables that are
/// modules of SQLite; a text or a blob is not longer than the file; and a row is found by its key or next to the last
/// one, in little work.
void Database::restrictReading() {
  std::error_code failed;
  bytesHeld_ = static_cast<std::int64_t>(std::min(fs::file_size(path_, failed), std::uintmax_t{INT_MAX}));
  sqlite3_limit(handle_.get(), SQLITE_LIMIT_LENGTH, std::max(static_cast<int>(bytesHeld_), kMinLength));
  const auto isTooMuch = [](void* turns) { return ++*static_cast<int*>(turns) > 1 ? 1 : 0; };
  sqlite3_progress_handler(handle_.get(), kLongTurn, isTooMuch, &longTurns_);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_db_config(handle_.get(), SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  std::array<const char*, 2> ownModules{"json_each", nullptr};
  sqlite3_drop_modules(handle_.get(), ownModules.data());
  sqlite3_limit(handle_.get(), SQLITE_LIMIT_SQL_LENGTH, kMaxDefinition);
  execute("PRAGMA query_only = ON; PRAGMA cell_size_check = ON; PRAGMA application_id");  // takes a journal back
  if (schemaRows(path_) > kMaxSchema)
    throw Error(ErrorKind::usage, path_,
                fmt::format("is not a trajectory: it defines more than {} tables, indices and views", kMaxSchema));
}

/// `name`: a plain one, or a URI.
void Database::open(const std::string& name, int flags) {
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(name.c_str(), &handle, flags, ownFilesOnly());
  handle_.reset(handle);
  if (code != SQLITE_OK) fail(code);
  sqlite3_busy_timeout(handle, kPatience);
}

void Database::execute(const std::string& sql) {
  beginWork();
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) fail(code);
}

Statement Database::prepare(const std::string& sql) {
  beginWork();
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v2(handle_.get(), sql.c_str(), -1, &statement, nullptr);
  if (code != SQLITE_OK) fail(code);
  return {*this, statement};
}

void Database::commit() {
  execute("COMMIT");
}

bool Database::tryCommit() {
  sqlite3_busy_timeout(handle_.get(), 0);
  const int code = sqlite3_exec(handle_.get(), "COMMIT", nullptr, nullptr, nullptr);
  if (code != SQLITE_OK && code != SQLITE_BUSY) fail(code);
  sqlite3_busy_timeout(handle_.get(), kPatience);
  return code == SQLITE_OK;
}

void Database::rollback() noexcept {
  // Some errors end the transaction by themselves; a second end would be an error of its own.
  if (sqlite3_get_autocommit(handle_.get()) == 0) sqlite3_exec(handle_.get(), "ROLLBACK", nullptr, nullptr, nullptr);
}

void Database::fail(int code) const {
  if (access_ == DatabaseAccess::read) failReading(code);
  if (code == SQLITE_FULL)
    throw Error(ErrorKind::output, path_, "the disk is full; free some space or choose another folder");
  if (code == SQLITE_BUSY)
    throw Error(ErrorKind::output, path_, "another program that reads it keeps it locked; close that program");
  const int cause = sqlite3_system_errno(handle_.get());
  const bool isOfWriting = cause == 0 && sqlite3_extended_errcode(handle_.get()) == SQLITE_IOERR_WRITE;
  const std::string because = isOfWriting  ? ": the file may not grow further (ulimit -f), or the disk fails"
                              : cause == 0 ? ""
                                           : fmt::format(": {}", std::strerror(cause));
  throw Error(ErrorKind::output, path_,
              fmt::format("cannot be written ({}{})", sqlite3_errmsg(handle_.get()), because));
}

void Database::failReading(int code) const {
  if (code == SQLITE_BUSY)
    throw Error(ErrorKind::usage, path_, "another program keeps it locked; try again when that has ended");
  if (code == SQLITE_READONLY)
    throw Error(ErrorKind::usage, path_, "was being written when that program ended; try again");
  if (code == SQLITE_CANTOPEN)
    throw Error(ErrorKind::usage, path_, "cannot be opened; it must be an existing file that may be read");
  if (code == SQLITE_INTERRUPT) failDamaged("its rows have no end or no order");
  throw Error(ErrorKind::usage, path_,
              fmt::format("is not a trajectory, or is damaged ({})", sqlite3_errmsg(handle_.get())));
}

void Database::failDamaged(const std::string& what) const {
  CRADLE_CHECK(access_ == DatabaseAccess::read);
  throw Error(ErrorKind::usage, path_, "is damaged: " + what + "; make it again with `cradle simulate`");
}

void Database::requireHeld(std::int64_t bytes) const {
  if (access_ != DatabaseAccess::read || bytes <= bytesHeld_) return;
  std::error_code failed;
  bytesHeld_ = static_cast<std::int64_t>(fs::file_size(path_, failed));  // it may have grown: a .part is being written
  if (failed || bytes > bytesHeld_) failDamaged("a query gives more than the file holds");
}

bool isBeingWritten(const std::string& path) {
  requireOwnJournal(path, ErrorKind::output);
  sqlite3* handle = nullptr;
  bool busy = false;
  if (sqlite3_open_v2(plainName(path).c_str(), &handle, SQLITE_OPEN_READWRITE, ownFilesOnly()) == SQLITE_OK)
    busy = sqlite3_exec(handle, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr) == SQLITE_BUSY;
  sqlite3_close(handle);
  return busy;
}

}  // namespace cradle
