#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

struct sqlite3;
struct sqlite3_stmt;

namespace cradle {

class Database;

/// A prepared statement: bind, step, read columns. Parameters count from 1, columns from 0.
class Statement {
 public:
  void bind(int parameter, std::integral auto value) { bindInteger(parameter, static_cast<std::int64_t>(value)); }
  void bind(int parameter, double value);  // bit by bit; not NaN, which SQLite would turn into null
  void bind(int parameter, const std::string& value);
  void bind(int parameter, std::span<const std::byte> value);  // not copied: must live until the statement has run
  void bindNull(int parameter);

  /// True if there is a row to read. A file that is read is damaged if a query gives more than the file holds, or needs
  /// much work for a row: pages that lead back to themselves have rows without end.
  bool step();
  /// Runs a statement that gives no rows, and makes it ready for the next values.
  void run();
  /// Makes a query ready to be asked again.
  void reset();

  bool isNull(int column) const;
  /// Each throws the database's error if the column holds another type. Views end with the next step or reset.
  std::int64_t integer(int column) const;
  double real(int column) const;  // below kLargestNumber
  std::string text(int column) const;
  std::string anyAsText(int column) const;  // numbers too
  std::span<const std::byte> blob(int column) const;

 private:
  friend class Database;
  struct Finalize {
    void operator()(sqlite3_stmt* statement) const;
  };
  Statement(const Database& database, sqlite3_stmt* statement) : database_(&database), statement_(statement) {}
  void bindInteger(int parameter, std::int64_t value);
  void check(int code) const;
  void requireType(int column, int type, const char* typeName) const;

  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalize> statement_;
  std::int64_t bytesGiven_ = 0;  // since the reset, of the rows' texts and blobs, and one for each row
};

/// What a file is opened for. What fails while writing throws Error(output), what fails while reading Error(usage): it
/// is then a file named on the command line that is wrong.
enum class DatabaseAccess { create, extend, read, unnamed };

/// One SQLite file. Statements must not outlive it. extend: a file that this program has written.
class Database {
 public:
  /// create: a new file at `path`, where nothing may be. read: an existing file, which may come from anywhere: what is
  /// beside it is not looked at, and neither is changed; save that in a FILE.part what a killed writer left half-done
  /// is taken back. A journal of such that names a file to be deleted, which ours never do, is refused. unnamed: a
  /// new one below TMPDIR that no name leads to, and that goes with the object or the process; `path` is not used.
  Database(const std::string& path, DatabaseAccess access);
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  void execute(const std::string& sql);
  Statement prepare(const std::string& sql);

  /// Waits half a minute for other programs that read.
  void commit();
  /// False if another program is reading just now: the transaction stays open and can be committed later.
  bool tryCommit();
  /// Undoes the open transaction, if there is one.
  void rollback() noexcept;

  /// Throws the error that a failed SQLite call stands for.
  [[noreturn]] void fail(int code) const;
  /// Throws the error of a file that holds what cannot be.
  [[noreturn]] void failDamaged(const std::string& what) const;
  /// Throws that of a file that is read and holds fewer bytes than a query has given.
  void requireHeld(std::int64_t bytes) const;
  /// To be called before a call of SQLite: the work of each is limited.
  void beginWork() const { longTurns_ = 0; }

 private:
  struct Close {
    void operator()(sqlite3* handle) const;
  };
  void open(const std::string& name, int flags);
  void restrictReading();
  [[noreturn]] void failReading(int code) const;

  std::string path_;
  DatabaseAccess access_;
  mutable int longTurns_ = 0;           // that the call of SQLite has taken so far
  mutable std::int64_t bytesHeld_ = 0;  // at least, by a file that is read
  std::unique_ptr<sqlite3, Close> handle_;
};

/// Whether another writer has a transaction open on the SQLite file at `path`. False for anything else at that place.
/// Throws Error(output) if a journal beside it is none of ours.
bool isBeingWritten(const std::string& path);

}  // namespace cradle
