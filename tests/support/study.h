// Fixture of the study tests: a small study in a temporary folder.
#pragma once

#include "item3d/study/answers.h"
#include "item3d/study/page_order.h"
#include "item3d/study/study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace item3d::testing {

/// Returns a study of two cases with three methods, one practice item and one attention check.
inline Study small_study() {
    Study study;
    study.seed = 3;
    study.title = "Edited <objects>";
    study.consent = "First & foremost.\n\nSecond.";
    study.methods = {"plain", "texture", "clip"};
    const auto add = [&](StudyItemKind kind, const std::string& name, const std::string& method) {
        StudyItem item;
        item.id = fmt::format("{:016x}", 4096 + study.items.size());
        item.kind = kind;
        item.case_name = name;
        item.method = method;
        item.from = "a red " + name;
        item.to = "a \"blue\" " + name;
        item.before = item.id + "b.png";
        item.after = item.id + "a.png";
        item.turntable = item.id + "t.webp";
        study.items.push_back(item);
    };
    add(StudyItemKind::practice, "mug", "");
    study.items.back().note = "Practice";
    for (const char* name : {"mug", "cow"})
        for (const std::string& method : study.methods)
            add(StudyItemKind::rating, name, method);
    add(StudyItemKind::attention, "cow", "");
    study.items.back().expected = {2, 5};
    return study;
}

class StudyFolder : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ =
            std::filesystem::temp_directory_path() / ("item3d_study_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_ / "pictures");
        for (const StudyItem& item : study_.items)
            for (const std::string& name : {item.before, item.after, item.turntable})
                std::ofstream(folder_ / "pictures" / name) << name;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    Study study_ = small_study();
    std::filesystem::path folder_;
};

}  // namespace item3d::testing
