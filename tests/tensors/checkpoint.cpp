#include "item3d/tensors/checkpoint.h"

#include "item3d/core/error.h"
#include "tests/support/networks.h"

namespace item3d {
namespace {

using testing::message_of;
using testing::resident_bytes;
using testing::TemporaryFolder;
using testing::write_file;

TEST(Checkpoint, KeepsTensorsOfWhichLittleWasTouched) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "checkpoint.safetensors";
    at::Tensor touched = at::zeros({100000, 3}), counts = at::zeros({100000}, at::kInt);
    touched[7][1] = 2.5f;
    touched[99999][0] = -1.0f;
    counts[99998] = 4;
    const NamedTensors tensors{{"touched", touched},
                               {"counts", counts},
                               {"full", at::ones({100000, 2})},
                               {"small", at::zeros({5})},
                               {"nothing", at::zeros({0})}};
    save_checkpoint(path, {{{"seed", 3}}, 12, tensors});
    EXPECT_LT(std::filesystem::file_size(path), 900000u);  // the tensors have 2.4 million bytes
    const auto found = load_checkpoint(path);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->iteration, 12);
    EXPECT_EQ(found->identity["seed"], 3);
    const CheckpointReader reader("here", found->tensors);
    for (const auto& [name, tensor] : tensors) {
        EXPECT_TRUE(at::equal(reader.get(name), tensor)) << name;
        EXPECT_EQ(reader.get(name).scalar_type(), tensor.scalar_type()) << name;
    }
    EXPECT_EQ(found->tensors.size(), tensors.size());
}

TEST(Checkpoint, TensorsOfADamagedFileUseNoMemory) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "checkpoint.safetensors";
    NamedTensors tensors;
    for (const char* name : {"a", "b"}) {
        tensors.emplace_back(std::string(name) + "#all", at::tensor({std::int64_t{200000000}}));
        tensors.emplace_back(std::string(name) + "#rows", at::tensor({std::int64_t{5}}));
        tensors.emplace_back(std::string(name) + "#values", at::tensor({2.5}, at::kDouble));
    }
    save_safetensors(path, tensors, {{"identity", "{}"}, {"iteration", "1"}});
    const auto before = resident_bytes();
    const auto found = load_checkpoint(path);
    EXPECT_LT(resident_bytes() - before, std::int64_t{64} << 20);
    ASSERT_EQ(found->tensors.size(), 2u);
    EXPECT_EQ(found->tensors[0].second.size(0), 200000000);
    EXPECT_EQ(found->tensors[0].second[5].item<double>(), 2.5);
    EXPECT_EQ(found->tensors[0].second[199999999].item<double>(), 0);
}

TEST(Checkpoint, SaysWhatDoesNotFit) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "checkpoint.safetensors";
    EXPECT_FALSE(load_checkpoint(path));
    write_file(path, "broken");
    EXPECT_THROW(load_checkpoint(path), InputError);
    save_safetensors(path, {{"x", at::ones({2})}});
    EXPECT_THROW(load_checkpoint(path), InputError);  // a file of another program

    const CheckpointReader reader("here", {{"x", at::ones({2})}});
    EXPECT_THROW(reader.get("y"), InputError);
    at::Tensor other = at::zeros({3});
    EXPECT_THROW(reader.copy("x", other), InputError);
    at::Tensor same = at::zeros({2});
    reader.copy("x", same);
    EXPECT_EQ(same[1].item<float>(), 1);

    const nlohmann::json saved{{"model", "a"}, {"steps", 3}};
    EXPECT_NO_THROW(require_same_identity("here", saved, saved, {}));
    EXPECT_EQ(message_of<InputError>([&] {
                  require_same_identity("here", saved, {{"model", "a"}, {"steps", 4}}, {});
              }),
              "here: was made with steps = 3, but this command has 4; use the same command, or "
              "leave out --resume to start from the beginning");
    EXPECT_EQ(message_of<InputError>([&] {
                  require_same_identity("here", saved, {{"alpha", 1}, {"model", "b"}},
                                        {{"model", "belongs to another model file"}});
              }),
              "here: belongs to another model file; use the same command, or leave out --resume to "
              "start from the beginning");
}

}  // namespace
}  // namespace item3d
