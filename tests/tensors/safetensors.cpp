#include "item3d/tensors/safetensors.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/core/random.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/weights.h"
#include "tests/support/networks.h"

#include <torch/nn/init.h>
#include <torch/nn/modules/linear.h>

#include <cstring>
#include <fstream>

namespace item3d {
namespace {

using testing::message_of;
using testing::resident_bytes;
using testing::TemporaryFolder;
using testing::write_file;

/// Returns a file with this header and `data_size` zero bytes as data.
std::string file_of(const std::string& header, std::size_t data_size) {
    std::string file(8, '\0');
    for (int i = 0; i < 8; ++i)
        file[i] = static_cast<char>(header.size() >> (8 * i) & 0xff);
    return file + header + std::string(data_size, '\0');
}

TEST(SafeTensors, KeepsEveryTypeShapeAndTheMetadata) {
    const TemporaryFolder folder;
    NamedTensors tensors;
    for (const auto dtype : {at::kDouble, at::kFloat, at::kHalf, at::kBFloat16, at::kLong, at::kInt,
                             at::kShort, at::kChar, at::kByte, at::kBool})
        tensors.emplace_back(std::string("x.") + c10::toString(dtype),
                             at::arange(7).reshape({1, 7}).to(dtype));
    tensors.emplace_back("scalar", at::scalar_tensor(2.5f));
    tensors.emplace_back("empty", at::empty({0, 3}));
    tensors.emplace_back("transposed", at::arange(6.0f).reshape({2, 3}).t());
    save_safetensors(folder.path() / "a.safetensors", tensors, {{"format", "pt"}});

    const SafeTensors file = SafeTensors::open(folder.path() / "a.safetensors");
    EXPECT_EQ(file.names().size(), tensors.size());
    EXPECT_EQ(file.metadata().at("format"), "pt");
    for (const auto& [name, tensor] : tensors) {
        EXPECT_EQ(file.tensor(name).scalar_type(), tensor.scalar_type()) << name;
        EXPECT_TRUE(file.tensor(name).equal(tensor)) << name;
    }
    EXPECT_FALSE(file.contains("y"));
    EXPECT_THROW(file.tensor("y"), InputError);
}

TEST(SafeTensors, TensorsOutliveTheReaderAndNeverWriteToTheFile) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.safetensors";
    save_safetensors(path, {{"x", at::arange(1000)}});
    at::Tensor x = SafeTensors::open(path).tensor("x");
    EXPECT_EQ(x.sum().item<int>(), 499500);
    x.zero_();
    EXPECT_EQ(SafeTensors::open(path).tensor("x").sum().item<int>(), 499500);
}

TEST(SafeTensors, ReadsTensorsThatAreNotAligned) {
    const TemporaryFolder folder;
    std::string file = file_of(R"({"b":{"dtype":"U8","shape":[1],"data_offsets":[0,1]},)"
                               R"("f":{"dtype":"F32","shape":[1],"data_offsets":[1,5]}})",
                               5);
    const float value = 3.25f;
    std::memcpy(file.data() + file.size() - 4, &value, 4);
    write_file(folder.path() / "a.safetensors", file);
    const at::Tensor f = SafeTensors::open(folder.path() / "a.safetensors").tensor("f");
    EXPECT_EQ(f.item<float>(), 3.25f);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(f.data_ptr()) % 4, 0u);
}

TEST(SafeTensors, RejectsMalformedFilesByName) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(testing::fixture("bad"))) {
        const std::string message =
            message_of<InputError>([&] { SafeTensors::open(entry.path()); });
        EXPECT_NE(message.find(entry.path().filename().string()), std::string::npos) << message;
        ++count;
    }
    EXPECT_GE(count, 4);
}

TEST(SafeTensors, RejectsHeadersThatDoNotFitTheData) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.safetensors";
    const std::pair<std::string, std::size_t> files[] = {
        {R"([])", 0},
        {R"({"x":3})", 0},
        {R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[0]}})", 4},
        {R"({"x":{"dtype":"Q4","shape":[1],"data_offsets":[0,4]}})", 4},
        {R"({"x":{"dtype":"F32","shape":[-1],"data_offsets":[0,4]}})", 4},
        {R"({"x":{"dtype":"F32","shape":[1.5],"data_offsets":[0,4]}})", 4},
        {R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[4,0]}})", 4},
        {R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[4,8]}})", 8},  // 0..4 unused
        {R"({"x":{"dtype":"F32","shape":[1],"data_offsets":[0,4]}})", 8},  // 4..8 unused
        {R"({"x":{"dtype":"F32","shape":[4294967296,4294967296],"data_offsets":[0,0]}})", 0},
        {R"({"__metadata__":{"a":1}})", 0},
    };
    for (const auto& [header, size] : files) {
        write_file(path, file_of(header, size));
        EXPECT_THROW(SafeTensors::open(path), InputError) << header;
    }
    EXPECT_THROW(SafeTensors::open(folder.path()), InputError);
    EXPECT_THROW(SafeTensors::open(folder.path() / "missing"), InputError);
}

TEST(SafeTensors, TruncatedAndDamagedFilesAreReadOrRejectedNeverMore) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "a.safetensors";
    save_safetensors(path, {{"x", at::arange(6.0f)}, {"y", at::ones({2, 2})}});
    const std::string whole = read_text(path);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        write_file(path, whole.substr(0, size));
        EXPECT_THROW(SafeTensors::open(path), InputError) << size;
    }
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        std::string damaged = whole;
        for (int j = 0; j < 2; ++j)
            damaged[random.index(static_cast<std::int64_t>(whole.size()) - 40)] =
                static_cast<char>(random.bits());
        write_file(path, damaged);
        try {
            for (const auto& [name, tensor] : SafeTensors::open(path).tensors())
                tensor.to(at::kFloat).sum();
        } catch (const InputError&) {
        }
    }
}

TEST(SafeTensors, AnUnwritableFolderIsReported) {
    EXPECT_THROW(save_safetensors("/nonexistent/a.safetensors", {{"x", at::ones(1)}}), Error);
}

TEST(Weights, FindsShardsThroughTheIndexAndStaysInTheFolder) {
    const TemporaryFolder folder;
    save_safetensors(folder.path() / "m-1.safetensors", {{"weight", at::ones({2, 3})}});
    save_safetensors(folder.path() / "m-2.safetensors", {{"bias", at::zeros(2)}});
    write_file(folder.path() / "m.safetensors.index.json",
               R"({"weight_map":{"weight":"m-1.safetensors","bias":"m-2.safetensors"}})");
    torch::nn::Linear linear(3, 2);
    load_parameters(*linear, Weights::open(folder.path(), "m"));
    EXPECT_TRUE(linear->weight.equal(at::ones({2, 3})));
    EXPECT_FALSE(linear->weight.requires_grad());

    write_file(folder.path() / "m.safetensors.index.json",
               R"({"weight_map":{"weight":"../m-1.safetensors"}})");
    EXPECT_THROW(Weights::open(folder.path(), "m"), InputError);
    const auto message = [&](const std::string& index) {
        write_file(folder.path() / "m.safetensors.index.json", index);
        return message_of<InputError>([&] { Weights::open(folder.path(), "m"); });
    };
    EXPECT_NE(message(R"({"weight_map":{"weight":"m-9.safetensors"}})")
                  .find("index.json: lists the shard m-9.safetensors, which does not exist"),
              std::string::npos);
    EXPECT_NE(message(R"({"weight_map":{"weight":"m-1.safetensors","scale":"m-1.safetensors"}})")
                  .find("m-1.safetensors: tensor 'scale', which the index lists, is missing"),
              std::string::npos);
    EXPECT_NE(message(R"({"weight_map":{"weight":"m-2.safetensors","bias":"m-1.safetensors"}})")
                  .find("which the index lists, is missing"),
              std::string::npos);
    EXPECT_THROW(Weights::open(folder.path(), "other"), InputError);
}

TEST(Weights, PicklesAreNamedAndNotRead) {
    const TemporaryFolder folder;
    write_file(folder.path() / "diffusion_pytorch_model.bin", "anything");
    const std::string message =
        message_of<InputError>([&] { Weights::open(folder.path(), "diffusion_pytorch_model"); });
    EXPECT_NE(message.find("diffusion_pytorch_model.bin: is a pickle"), std::string::npos);
    EXPECT_NE(message.find("safetensors"), std::string::npos);
}

TEST(Weights, ALinkThatLeadsNowhereIsNamed) {
    const TemporaryFolder folder;
    std::filesystem::create_symlink("../blobs/gone", folder.path() / "m.safetensors");
    EXPECT_NE(message_of<InputError>([&] {
                  Weights::open(folder.path(), "m");
              }).find("m.safetensors: links to a file that does not exist"),
              std::string::npos);
}

TEST(Weights, EveryFloatingPointTypeIsConverted) {
    const TemporaryFolder folder;
    const at::Tensor weight = at::arange(6.0f).reshape({2, 3}) / 4;
    for (const auto stored :
         {at::kFloat, at::kHalf, at::kBFloat16, at::kDouble, at::kFloat8_e4m3fn, at::kFloat8_e5m2})
        for (const auto wanted : {at::kFloat, at::kHalf, at::kBFloat16}) {
            save_safetensors(folder.path() / "m.fp16.safetensors",
                             {{"weight", weight.to(stored)}, {"bias", at::ones(2)}});
            torch::nn::Linear linear(3, 2);
            load_parameters(*linear, Weights::open(folder.path(), "m"), at::kCPU, wanted);
            EXPECT_EQ(linear->weight.scalar_type(), wanted);
            EXPECT_TRUE(linear->weight.equal(weight.to(wanted)));
        }
}

TEST(Weights, MetaComparesAndReadsNothing) {
    const TemporaryFolder folder;
    save_safetensors(folder.path() / "m.safetensors",
                     {{"weight", at::ones({2, 3})}, {"bias", at::ones(2)}});
    auto linear = without_initial_values([] { return torch::nn::Linear(3, 2); });
    torch::nn::init::constant_(linear->weight, 5);
    load_parameters(*linear, Weights::open(folder.path(), "m"), at::kMeta);
    EXPECT_EQ(linear->weight.sum().item<float>(), 30);
    torch::nn::Linear wide(4, 2);
    EXPECT_THROW(load_parameters(*wide, Weights::open(folder.path(), "m"), at::kMeta), InputError);
}

TEST(Weights, WithoutInitialValuesTheMemoryIsLeftAlone) {
    // A gibibyte of memory is never written, and untouched pages are never committed.
    const auto before = resident_bytes();
    const auto linear = without_initial_values([] { return torch::nn::Linear(16384, 16384); });
    EXPECT_EQ(linear->weight.numel(), 16384 * 16384);
    EXPECT_LT(resident_bytes() - before, std::int64_t(64) << 20);
}

TEST(Weights, MessagesNameTheTensor) {
    const TemporaryFolder folder;
    const auto load = [&](const NamedTensors& tensors) {
        save_safetensors(folder.path() / "m.safetensors", tensors);
        return message_of<InputError>([&] {
            torch::nn::Linear linear(3, 2);
            load_parameters(*linear, Weights::open(folder.path(), "m"));
        });
    };
    const at::Tensor weight = at::ones({2, 3}), bias = at::ones(2);
    EXPECT_NE(load({{"weight", weight}}).find("'bias' of shape [2] is missing"), std::string::npos);
    EXPECT_NE(
        load({{"weight", weight.t()}, {"bias", bias}}).find("expected shape [2, 3], found [3, 2]"),
        std::string::npos);
    EXPECT_NE(
        load({{"weight", weight}, {"bias", bias}, {"scale", bias}}).find("'scale' is unexpected"),
        std::string::npos);
    EXPECT_NE(load({{"weight", weight}, {"bias", bias.to(at::kLong)}}).find("'bias' is not"),
              std::string::npos);
    EXPECT_NE(load({{"scale", bias}}).find("(and 2 more tensors do not fit)"), std::string::npos);
}

}  // namespace
}  // namespace item3d
