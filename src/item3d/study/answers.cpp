#include "item3d/study/answers.h"

#include "item3d/core/error.h"
#include "item3d/serve/secret.h"

namespace item3d {
namespace {

namespace fs = std::filesystem;

constexpr const char* schema = R"(
CREATE TABLE study(fingerprint TEXT NOT NULL);
CREATE TABLE participants(
    number INTEGER PRIMARY KEY,
    token TEXT NOT NULL UNIQUE,
    agreed_at TEXT);
CREATE TABLE answers(
    participant INTEGER NOT NULL REFERENCES participants(number),
    item TEXT NOT NULL,
    photorealism INTEGER NOT NULL CHECK (photorealism BETWEEN 1 AND 5),
    text_consistency INTEGER NOT NULL CHECK (text_consistency BETWEEN 1 AND 5),
    given_at TEXT NOT NULL,
    PRIMARY KEY (participant, item));
)";
static_assert(study_questions.size() == 2 && min_rating == 1 && max_rating == 5);

constexpr int token_bytes = 10;

fs::path database_of(const fs::path& folder) {
    return folder / "answers.sqlite";
}

/// Opens and checks the database of `study`.
std::unique_ptr<Sqlite> open_database(const fs::path& folder, const Study& study, bool may_create) {
    const fs::path path = database_of(folder);
    const bool is_new = !fs::exists(path);
    if (is_new && !may_create)
        throw InputError(path.string(), "does not exist, because there are no answers yet",
                         "run `item3d study serve` first");
    if (!is_new && !fs::is_regular_file(path))
        throw InputError(path.string(), "is not a file", "restore a backup, or remove it");
    // SQLite accepts an empty file, and a file of a single byte, as a new database.
    if (!is_new && fs::file_size(path) <= 1)
        throw InputError(path.string(), "is empty",
                         "restore a backup, or delete it to start again");
    auto database = std::make_unique<Sqlite>(path, is_new);
    if (is_new) {
        SqliteTransaction transaction(*database);
        database->run(schema);
        SqliteRows rows(*database, "INSERT INTO study VALUES (?)");
        rows.bind(study.fingerprint());
        rows.next();
        transaction.commit();
    }
    database->check();
    SqliteRows rows(*database, "SELECT fingerprint FROM study");
    if (!rows.next() || rows.text(0) != study.fingerprint())
        throw InputError(path.string(), "contains the answers to another study.json",
                         "restore that study.json, or make a new study in another folder");
    return database;
}

Participant read_participant(const SqliteRows& rows) {
    return {rows.number(0), rows.text(1), !rows.text(2).empty()};
}

}  // namespace

AnswerStore::AnswerStore(const fs::path& folder, const Study& study)
    : lock_(folder, "`item3d study serve`"), database_(open_database(folder, study, true)) {}

void AnswerStore::add_participants(int count) {
    auto there = static_cast<int>(participants().size());
    const std::lock_guard guard(mutex_);
    SqliteTransaction transaction(*database_);
    while (there < count) {
        SqliteRows rows(*database_, "INSERT INTO participants(number, token) VALUES (?, ?)");
        rows.bind(std::int64_t{++there});
        rows.bind(random_secret(token_bytes));
        rows.next();
    }
    transaction.commit();
}

std::vector<Participant> AnswerStore::participants() {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(*database_,
                    "SELECT number, token, agreed_at FROM participants ORDER BY number");
    std::vector<Participant> all;
    while (rows.next())
        all.push_back(read_participant(rows));
    return all;
}

std::optional<Participant> AnswerStore::find(const std::string& token) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(*database_,
                    "SELECT number, token, agreed_at FROM participants WHERE token = ?");
    rows.bind(token);
    if (!rows.next()) return std::nullopt;
    return read_participant(rows);
}

void AnswerStore::agree(std::int64_t participant) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(*database_,
                    "UPDATE participants SET agreed_at = strftime('%Y-%m-%dT%H:%M:%SZ', 'now') "
                    "WHERE number = ? AND agreed_at IS NULL");
    rows.bind(participant);
    rows.next();
}

void AnswerStore::store(std::int64_t participant, const std::string& item,
                        const StudyAnswer& answer) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(*database_,
                    "INSERT OR REPLACE INTO answers VALUES (?, ?, ?, ?, "
                    "strftime('%Y-%m-%dT%H:%M:%SZ', 'now'))");
    rows.bind(participant);
    rows.bind(item);
    for (const int value : answer)
        rows.bind(std::int64_t{value});
    rows.next();
}

AnswersByItem AnswerStore::answers(std::int64_t participant) {
    const std::lock_guard guard(mutex_);
    SqliteRows rows(*database_,
                    "SELECT item, photorealism, text_consistency FROM answers WHERE participant = "
                    "?");
    rows.bind(participant);
    AnswersByItem answers;
    while (rows.next())
        answers[rows.text(0)] = {static_cast<int>(rows.number(1)),
                                 static_cast<int>(rows.number(2))};
    return answers;
}

std::map<std::int64_t, AnswersByItem> read_answers(const fs::path& folder, const Study& study) {
    const auto database = open_database(folder, study, false);
    SqliteRows rows(*database,
                    "SELECT participant, item, photorealism, text_consistency FROM answers");
    std::map<std::int64_t, AnswersByItem> answers;
    while (rows.next())
        answers[rows.number(0)][rows.text(1)] = {static_cast<int>(rows.number(2)),
                                                 static_cast<int>(rows.number(3))};
    return answers;
}

}  // namespace item3d
