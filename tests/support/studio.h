// Fixture of the studio's tests: a folder, and stand-ins for the programs that the studio starts.
#pragma once

#include "item3d/studio/server.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>

namespace item3d::testing {

/// Stand-in for item3d-edit, which ends after a tenth of a second. The target sentence controls it:
/// with "slow" it runs until it is asked to end, and then writes a checkpoint; with "broken" it
/// fails.
inline constexpr const char* stand_in_for_edit = R"(#!/bin/sh
line="$*"
while [ $# -gt 0 ]; do
    case "$1" in
        -o) out=$2 ;;
        --live) live=$2 ;;
        --progress-file) progress=$2 ;;
        --resume) resumed=yes ;;
    esac
    shift
done
case "$line" in
    layers*|variants*) echo "$line" > "$out"; exit ;;
    region*) mkdir -p "$out"; echo pixels > "$out/mask_glaze.png"
        echo '{"share": 0.25, "materials": [{"name": "glaze", "mask": "mask_glaze.png"}]}' > "$out/region.json"
        exit ;;
esac
live=${live:-$out}
progress=${progress:-$out/progress.json}
echo "$line" >> "$out/lines.txt"
case "$line" in *broken*) echo "item3d: error: $PWD/source: cannot be; try another" >&2; exit 3 ;; esac
echo '{"stage": "edit", "done": 1, "total": 9, "seconds_left": 2}' > "$progress"
printf texels > "$live/0_base_color.png"
echo '{"revision": 1, "textures": [{"material": 0, "slot": "base_color", "file": "0_base_color.png"}], "direction": [1]}' > "$live/textures.json"
case "$line" in
    *slow*)
        if [ -z "$resumed" ]; then
            trap 'echo kept > "$out/checkpoint.safetensors"; exit 130' TERM
            n=0
            while [ $n -lt 600 ]; do sleep 0.05; n=$((n + 1)); done
        fi ;;
esac
sleep 0.1
cp "$(dirname "$out")/../source/"* "$out/model.glb"
echo '{"scores": {"detail_kept": 0.9}, "model": "'$PWD'/source"}' > "$out/edit.json"
)";

/// Stand-in for item3d-studio read-model.
inline constexpr const char* stand_in_for_studio = R"(#!/bin/sh
grep -q glTF "$2" || { echo "item3d: error: $2: is no model; take one" >&2; exit 3; }
cp "$2" "$3/model.glb"
echo '{"format": "glb", "triangles": 1, "materials": [{"index": 0, "name": "glaze"}]}' > "$3/model.json"
)";

class StudioFolder : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::temp_directory_path() /
                  ("item3d_studio_" + std::to_string(::getpid()));
        std::filesystem::remove_all(folder_);
        options_.folder = folder_ / "data";
        options_.page = folder_ / "page";
        options_.three = folder_ / "three";
        options_.programs = folder_ / "programs";
        options_.access = {"0123456789abcdef", "", "item3d_test", ""};
        for (const auto& made : {options_.folder, options_.page, options_.three, options_.programs})
            std::filesystem::create_directories(made);
        write(options_.page / "index.html",
              "<script type=\"importmap\">{}</script><p>the page</p>");
        write(options_.page / "settings.json", R"([
            {"name": "from", "flag": "--from", "type": "text"},
            {"name": "seed", "flag": "--seed", "type": "integer"},
            {"name": "iterations", "flag": "--iterations", "type": "integer", "minimum": 0,
             "values": "0 or more"},
            {"name": "cfg", "flag": "--cfg", "type": "number", "minimum": -1000, "maximum": 1000},
            {"name": "detail", "flag": "--detail", "type": "choice", "choices": ["auto", "off"]},
            {"name": "light", "flag": "--light", "type": "text"},
            {"name": "keep", "flag": "--keep", "type": "texts"},
            {"name": "region", "flag": "--region", "type": "repeated_texts"},
            {"name": "lora", "flag": "--lora", "type": "repeated_texts", "path": true}])");
        program("item3d-edit", stand_in_for_edit);
        program("item3d-studio", stand_in_for_studio);
        write(folder_ / "mug.glb", "glTF and more");
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    static void write(const std::filesystem::path& path, const std::string& text) {
        std::ofstream(path, std::ios::binary) << text;
    }
    static std::string read(const std::filesystem::path& path) {
        std::ifstream file(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    void program(const std::string& name, const std::string& script) const {
        write(options_.programs / name, script);
        ::chmod((options_.programs / name).c_str(), 0755);
    }
    /// Returns an edit of the project with the given target sentence.
    static StudioResult edit(std::int64_t project, const std::string& to) {
        StudioResult result;
        result.project = project;
        result.request = {{"from", "a red mug"}, {"to", to}};
        return result;
    }
    static bool wait_until(const std::function<bool()>& is_so) {
        const auto last = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (!is_so()) {
            if (std::chrono::steady_clock::now() > last) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return true;
    }
    static bool wait_for(Studio& studio, std::int64_t result, ResultState state) {
        return wait_until([&] { return studio.result(result).state == state; });
    }

    std::filesystem::path folder_;
    StudioOptions options_;
};

}  // namespace item3d::testing
