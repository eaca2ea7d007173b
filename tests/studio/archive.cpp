// Tests of uploaded archives: finding the model in them, and refusing malicious ones.
#include "item3d/studio/archive.h"

#include "item3d/core/error.h"
#include "tests/support/studio.h"

#include <zip.h>

#include <utility>
#include <vector>

namespace item3d::testing {
namespace {

namespace fs = std::filesystem;

class StudioArchive : public StudioFolder {
  protected:
    using Files = std::vector<std::pair<std::string, std::string>>;

    fs::path pack(const Files& files) const {
        const fs::path path = folder_ / "model.zip";
        fs::remove(path);
        zip_t* archive = zip_open(path.c_str(), ZIP_CREATE, nullptr);
        for (const auto& [name, content] : files)
            zip_file_add(archive, name.c_str(),
                         zip_source_buffer(archive, content.data(), content.size(), 0), 0);
        zip_close(archive);
        return path;
    }
    fs::path unpack(const Files& files, const ArchiveLimits& limits = {}) const {
        return unpack_model(pack(files), folder_ / "unpacked", limits);
    }
    std::string refusal(const Files& files, const ArchiveLimits& limits = {}) const {
        try {
            unpack(files, limits);
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    }
};

TEST_F(StudioArchive, GivesTheModelNearestToTheTop) {
    const fs::path model = unpack({{"mug/parts/lid.obj", "large enough to be the larger one"},
                                   {"mug/mug.obj", "a"},
                                   {"mug/mug.mtl", "b"},
                                   {"mug/READ.ME", "c"},
                                   {"mug/run.sh", "d"}});
    EXPECT_EQ(model, folder_ / "unpacked/mug/mug.obj");
    EXPECT_EQ(read(folder_ / "unpacked/mug/mug.mtl"), "b");
    EXPECT_FALSE(fs::exists(folder_ / "unpacked/mug/run.sh")) << "only what models are made of";
}

TEST_F(StudioArchive, RefusesNamesThatLeadOut) {
    for (const char* name :
         {"../mug.glb", "a/../../mug.glb", "/mug.glb", "..\\mug.glb", "C:\\mug.glb", "a\n.glb"})
        EXPECT_NE(refusal({{name, "glTF"}}).find("invalid or outside its folder"),
                  std::string::npos)
            << name;
    EXPECT_FALSE(fs::exists(folder_ / "mug.glb") && read(folder_ / "mug.glb") == "glTF");
}

TEST_F(StudioArchive, RefusesNamesThatAreTooLong) {
    const std::string longest(196, 'n');
    EXPECT_EQ(refusal({{longest + ".glb", "glTF"}, {longest + "/textures/a.png", "png"}}), "");
    for (const std::string& name : {longest + "n.glb", longest + "nnnnn/mug.glb"})
        EXPECT_NE(refusal({{name, "glTF"}}).find("a file name of more than 200 bytes: nnn"),
                  std::string::npos)
            << name;
}

TEST_F(StudioArchive, RefusesWhatUnpacksToTooMuch) {
    const std::string zeros(3 << 20, '\0');
    EXPECT_NE(refusal({{"mug.glb", zeros}}, {.bytes = 1 << 20}).find("unpacks to more than 1 MB"),
              std::string::npos);
    EXPECT_FALSE(fs::exists(folder_ / "unpacked/mug.glb")) << "nothing half-written";
    EXPECT_EQ(refusal({{"mug.glb", zeros}}), "");
    EXPECT_NE(
        refusal({{"a.png", ""}, {"b.png", ""}, {"c.glb", ""}}, {.entries = 2}).find("3 files"),
        std::string::npos);
}

TEST_F(StudioArchive, RefusesWhatIsNone) {
    EXPECT_NE(refusal({{"notes.txt", "no"}}).find("no model"), std::string::npos);
    const fs::path path = pack({{"mug.glb", std::string(5000, 'm')}});
    fs::resize_file(path, fs::file_size(path) / 2);
    EXPECT_THROW(unpack_model(path, folder_ / "unpacked"), InputError);
    write(path, "PK and no more");
    EXPECT_THROW(unpack_model(path, folder_ / "unpacked"), InputError);
}

}  // namespace
}  // namespace item3d::testing
