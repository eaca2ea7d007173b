// Definition of a study, with its items and questions. It is in study.json in the study's folder.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace item3d {

/// One of the two questions of the paper's study. Answers are numbers from 1 to 5.
struct StudyQuestion {
    std::string_view id, text, low, high;
};
inline constexpr std::array study_questions = {
    StudyQuestion{"photorealism", "How photorealistic is the edited object?", "1: not at all",
                  "5: like a photograph"},
    StudyQuestion{"text_consistency", "How well does the edited object agree with the sentence?",
                  "1: not at all", "5: fully"}};
using StudyAnswer = std::array<int, study_questions.size()>;
inline constexpr int min_rating = 1, max_rating = 5;

enum class StudyItemKind { practice, rating, attention };
/// Returns the kind's name in study.json.
std::string_view kind_name(StudyItemKind kind);

/// One page of the study.
struct StudyItem {
    std::string id;  ///< 16 hexadecimal digits that do not reveal the method
    StudyItemKind kind = StudyItemKind::rating;
    std::string case_name, method, from, to;
    std::string note;                      ///< text above a practice item
    std::string before, after, turntable;  ///< names in the folder pictures/
    StudyAnswer expected{};                ///< required answer of an attention item
    std::map<std::string, double> scores;  ///< columns of table.csv that the analysis passes on
};

struct Study {
    std::uint64_t seed = 0;
    std::string title, consent;
    std::vector<std::string> methods;
    std::vector<StudyItem> items;

    /// Returns the item with this id. Throws std::out_of_range if there is none.
    const StudyItem& item(const std::string& id) const;
    /// Returns a hash of everything that participants see. By this hash, answers of another study
    /// are refused.
    std::string fingerprint() const;
};

/// Writes FOLDER/study.json.
void write_study(const Study& study, const std::filesystem::path& folder);
/// Reads FOLDER/study.json. Throws InputError if it is missing or invalid.
Study read_study(const std::filesystem::path& folder);
/// Throws InputError that names the first image in FOLDER/pictures that is missing or empty.
void check_study_images(const Study& study, const std::filesystem::path& folder);

}  // namespace item3d
