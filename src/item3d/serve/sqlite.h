// SQLite wrapper: a database file and its statements. SQLite's errors become item3d's exceptions.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct sqlite3;
struct sqlite3_stmt;

namespace item3d {

/// Database file. Every member throws InputError for a file that is damaged, not a database or not
/// writable, and ResourceError for a full disk or a file that another program keeps locked for five
/// seconds. Only one thread at a time may use an object.
class Sqlite {
  public:
    /// Opens the file; creates it if may_create.
    Sqlite(std::filesystem::path path, bool may_create);
    Sqlite(const Sqlite&) = delete;
    Sqlite& operator=(const Sqlite&) = delete;

    /// Runs statements without results and parameters, separated by semicolons.
    void run(const std::string& statements);
    /// Throws if the file is truncated or its pages are inconsistent (PRAGMA quick_check).
    void check();

  private:
    friend class SqliteRows;
    [[noreturn]] void fail(int code) const;
    [[noreturn]] void fail_as_damaged(const std::string& how) const;
    void expect(int code) const;

    struct Close {
        void operator()(sqlite3* database) const;
    };

    std::filesystem::path path_;
    std::unique_ptr<sqlite3, Close> database_;
};

/// One statement with parameters ("?"), and its rows.
///
///     SqliteRows rows(database, "SELECT item FROM answers WHERE participant = ?");
///     rows.bind(participant);
///     while (rows.next()) use(rows.text(0));
class SqliteRows {
  public:
    SqliteRows(Sqlite& database, const std::string& statement);
    ~SqliteRows();
    SqliteRows(const SqliteRows&) = delete;
    SqliteRows& operator=(const SqliteRows&) = delete;

    /// Binds the next parameter.
    void bind(std::int64_t value);
    void bind(double value);
    void bind(const std::string& value);
    /// Runs the statement, or advances to its next row. Returns false after the last.
    bool next();
    std::int64_t number(int column) const;
    double real(int column) const;
    /// Returns the text of a column; empty for NULL.
    std::string text(int column) const;

  private:
    Sqlite& database_;
    sqlite3_stmt* statement_ = nullptr;
    int bound_ = 0;
};

/// A transaction, which is rolled back on destruction unless commit() was called.
class SqliteTransaction {
  public:
    explicit SqliteTransaction(Sqlite& database);
    ~SqliteTransaction();
    SqliteTransaction(const SqliteTransaction&) = delete;
    SqliteTransaction& operator=(const SqliteTransaction&) = delete;
    void commit();

  private:
    Sqlite& database_;
    bool is_open_ = true;
};

}  // namespace item3d
