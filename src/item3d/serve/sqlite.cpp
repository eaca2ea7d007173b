#include "item3d/serve/sqlite.h"

#include "item3d/core/error.h"

#include <sqlite3.h>

namespace item3d {

Sqlite::Sqlite(std::filesystem::path path, bool may_create) : path_(std::move(path)) {
    const int flags = SQLITE_OPEN_READWRITE | (may_create ? SQLITE_OPEN_CREATE : 0);
    sqlite3* opened = nullptr;
    const int code = sqlite3_open_v2(path_.c_str(), &opened, flags, nullptr);
    database_.reset(opened);  // the handle must be closed even if opening failed
    if (code != SQLITE_OK)
        throw InputError(path_.string(),
                         std::string("cannot be opened (") + sqlite3_errmsg(opened) + ")",
                         "check the permissions of the folder");
    sqlite3_busy_timeout(opened, 5000);
    // A change must be on disk before the reply.
    run("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON");
}

void Sqlite::Close::operator()(sqlite3* database) const {
    sqlite3_close(database);
}

void Sqlite::fail_as_damaged(const std::string& how) const {
    throw InputError(
        path_.string(), "is damaged (" + how + ") and was not changed",
        "restore a backup, or recover the readable part: sqlite3 FILE .recover | sqlite3 NEW");
}

void Sqlite::fail(int code) const {
    const std::string message = sqlite3_errmsg(database_.get());
    switch (code) {
        case SQLITE_CORRUPT:
        case SQLITE_NOTADB:
            fail_as_damaged(message);
        case SQLITE_FULL:
            throw ResourceError(path_.string() + ": the disk is full; free some space");
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
            throw ResourceError(path_.string() + ": it is locked by another program");
        default:
            throw InputError(path_.string(), "cannot be read or written (" + message + ")",
                             "check the disk and the permissions of the folder");
    }
}

void Sqlite::expect(int code) const {
    if (code != SQLITE_OK && code != SQLITE_ROW && code != SQLITE_DONE) fail(code);
}

void Sqlite::run(const std::string& statements) {
    expect(sqlite3_exec(database_.get(), statements.c_str(), nullptr, nullptr, nullptr));
}

void Sqlite::check() {
    // After a crash the newest pages are only in the write-ahead log, so the file would seem too
    // short.
    run("PRAGMA wal_checkpoint(TRUNCATE)");
    SqliteRows sizes(*this,
                     "SELECT page_count * page_size FROM pragma_page_count, pragma_page_size");
    sizes.next();
    // quick_check does not find a truncated last page, because SQLite reads its missing bytes as
    // zeros.
    if (std::filesystem::file_size(path_) < static_cast<std::uintmax_t>(sizes.number(0)))
        fail_as_damaged("cut off");
    SqliteRows rows(*this, "PRAGMA quick_check(1)");
    if (!rows.next() || rows.text(0) != "ok") fail_as_damaged(rows.text(0));
}

SqliteRows::SqliteRows(Sqlite& database, const std::string& statement) : database_(database) {
    database.expect(
        sqlite3_prepare_v2(database.database_.get(), statement.c_str(), -1, &statement_, nullptr));
}

SqliteRows::~SqliteRows() {
    sqlite3_finalize(statement_);
}

void SqliteRows::bind(std::int64_t value) {
    database_.expect(sqlite3_bind_int64(statement_, ++bound_, value));
}

void SqliteRows::bind(double value) {
    database_.expect(sqlite3_bind_double(statement_, ++bound_, value));
}

void SqliteRows::bind(const std::string& value) {
    database_.expect(sqlite3_bind_text(statement_, ++bound_, value.c_str(),
                                       static_cast<int>(value.size()), SQLITE_TRANSIENT));
}

bool SqliteRows::next() {
    const int code = sqlite3_step(statement_);
    database_.expect(code);
    return code == SQLITE_ROW;
}

std::int64_t SqliteRows::number(int column) const {
    return sqlite3_column_int64(statement_, column);
}

double SqliteRows::real(int column) const {
    return sqlite3_column_double(statement_, column);
}

std::string SqliteRows::text(int column) const {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return text ? text : "";
}

SqliteTransaction::SqliteTransaction(Sqlite& database) : database_(database) {
    database.run("BEGIN IMMEDIATE");
}

SqliteTransaction::~SqliteTransaction() {
    if (!is_open_) return;
    try {
        database_.run("ROLLBACK");
    } catch (const Error&) {
        // SQLite has already rolled back.
    }
}

void SqliteTransaction::commit() {
    database_.run("COMMIT");
    is_open_ = false;
}

}  // namespace item3d
