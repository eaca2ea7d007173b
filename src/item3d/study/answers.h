// The participants of a study and what they answered: answers.sqlite in its folder.
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
    std::int64_t number = 0;  ///< from 1; decides order and sides
    std::string token;        ///< 20 hexadecimal digits, the secret of the link
    bool has_agreed = false;  ///< to the consent text
};

using AnswersByItem = std::map<std::string, StudyAnswer>;

/// Open for answers. One at a time has a study's folder: the file `lock` is locked until the end.
/// Members may be called by several threads; each returns when what it changed is on the disk. All
/// throw what Sqlite throws.
class AnswerStore {
  public:
    /// Opens the database of the study in `folder`, or makes it. Throws InputError where another
    /// AnswerStore has the folder, where the database is damaged, cut off or of another study.
    AnswerStore(const std::filesystem::path& folder, const Study& study);

    /// Adds participants until there are `count`; removes none.
    void add_participants(int count);
    std::vector<Participant> participants();
    std::optional<Participant> find(const std::string& token);
    void agree(std::int64_t participant);
    /// An answer that is there already is replaced. answer: min_rating to max_rating.
    void store(std::int64_t participant, const std::string& item, const StudyAnswer& answer);
    AnswersByItem answers(std::int64_t participant);

  private:
    std::mutex mutex_;
    FolderLock lock_;
    std::unique_ptr<Sqlite> database_;
};

/// All answers, by participant; also while a server runs. Participants without answers are not in
/// it. Throws InputError where there is no database, or as AnswerStore does.
std::map<std::int64_t, AnswersByItem> read_answers(const std::filesystem::path& folder,
                                                   const Study& study);

}  // namespace item3d
