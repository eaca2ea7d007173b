// Participants of a study and their answers, in answers.sqlite in its folder.
#pragma once

#include "item3d/serve/folder_lock.h"
#include "item3d/serve/sqlite.h"
#include "item3d/study/study.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct Participant {
    /// Number from 1; determines the order of pages and the sides of images.
    std::int64_t number = 0;
    std::string token;        ///< 20 hexadecimal digits, the secret of the link
    bool has_agreed = false;  ///< true after consent
};

using AnswersByItem = std::map<std::string, StudyAnswer>;

/// Store of answers. It holds the lock of the study's folder, so that one process at a time writes.
/// It is thread-safe. Each member function returns when its change is on disk. All member functions
/// throw like Sqlite.
class AnswerStore {
  public:
    /// Opens the database of the study in `folder`, or creates it. Throws InputError if another
    /// AnswerStore holds the folder, or if the database is damaged, truncated or of another study.
    AnswerStore(const std::filesystem::path& folder, const Study& study);

    /// Adds participants until there are `count`. Removes none.
    void add_participants(int count);
    std::vector<Participant> participants();
    std::optional<Participant> find(const std::string& token);
    void agree(std::int64_t participant);
    /// Stores or replaces an answer. Its ratings must be from min_rating to max_rating.
    void store(std::int64_t participant, const std::string& item, const StudyAnswer& answer);
    AnswersByItem answers(std::int64_t participant);

  private:
    std::mutex mutex_;
    FolderLock lock_;
    std::unique_ptr<Sqlite> database_;
};

/// Returns all answers by participant, also while a server runs. Participants without answers are
/// left out. Throws InputError if there is no database, or like AnswerStore.
std::map<std::int64_t, AnswersByItem> read_answers(const std::filesystem::path& folder,
                                                   const Study& study);

}  // namespace item3d
