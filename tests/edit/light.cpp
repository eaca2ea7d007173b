// Tests of edits that change the light: unchanged parts, and resuming to the same bytes.
#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "tests/support/edit.h"

#include <filesystem>
#include <string>

namespace item3d {
namespace {

using testing::EditTest;

class EditLightTest : public EditTest {
  protected:
    EditRequest light_request(const std::string& output, const std::string& optimize,
                              const std::string& kind) const {
        return request(output, 4, {{"optimize", optimize}, {"light_model", kind}});
    }
};

TEST_F(EditLightTest, LightAloneLeavesTheModelByteForByte) {
    const EditRequest edit = light_request("light", "light", "physical");
    edit_model(edit);
    EXPECT_EQ(read_bytes(edit.output / "model.glb"), read_bytes(edit.model));
    EXPECT_GT(load_image(edit.output / "light.exr").height, 100);
}

TEST_F(EditLightTest, ResumesToTheSameLightAndTexture) {
    for (const std::string kind : {"physical", "texels"}) {
        EditRequest edit = light_request("whole-" + kind, "both", kind);
        edit_model(edit);
        const Bytes light = read_bytes(edit.output / "light.exr");
        const Bytes model = read_bytes(edit.output / "model.glb");
        EXPECT_NE(model, read_bytes(edit.model));

        edit.output = folder_ / ("parts-" + kind);
        edit.stop_after = 2;
        EXPECT_THROW(edit_model(edit), Interrupted);
        edit.resume = true;
        edit.stop_after = 0;
        edit_model(edit);
        EXPECT_EQ(light, read_bytes(edit.output / "light.exr")) << kind;
        EXPECT_EQ(model, read_bytes(edit.output / "model.glb")) << kind;
    }
}

}  // namespace
}  // namespace item3d
