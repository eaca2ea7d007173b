#include "item3d/core/error.h"
#include "item3d/guidance/guidance_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace item3d {
namespace {

/// Returns a source of bytes that delivers at most `step` of them at once, as a pipe does.
ReadBytes reader_of(std::string bytes, std::size_t step = 1000) {
    return
        [bytes = std::move(bytes), at = std::size_t(0), step](char* to, std::size_t size) mutable {
            const std::size_t count = std::min({size, step, bytes.size() - at});
            std::copy_n(bytes.data() + at, count, to);
            at += count;
            return count;
        };
}

std::string bytes_of(const at::Tensor& tensor) {
    const at::Tensor dense = tensor.contiguous();
    return {static_cast<const char*>(dense.const_data_ptr()), dense.nbytes()};
}

std::string refusal(const std::string& bytes) {
    try {
        read_guidance_request(reader_of(bytes));
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

const std::string small = R"({"iteration": 0, "views": 1, "height": 8, "width": 8)";

}  // namespace

TEST(GuidanceStream, ReadsRequestsInTheirOrder) {
    const at::Tensor images = at::rand({2, 3, 8, 16}), depth = at::rand({2, 8, 16});
    const at::Tensor position = at::rand({2, 8, 16, 3}), normal = at::rand({2, 8, 16, 3});
    const at::Tensor reference = at::rand({2, 3, 8, 16});
    const std::string whole =
        R"({"iteration": 7, "views": 2, "height": 8, "width": 16, "depth": true, "surface": true, )"
        R"("reference": true})"
        "\n" +
        bytes_of(images) + bytes_of(depth) + bytes_of(position) + bytes_of(normal) +
        bytes_of(reference);
    const ReadBytes read = reader_of(whole + small + "}\n" + bytes_of(images[0].slice(2, 0, 8)));

    const auto first = read_guidance_request(read);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->iteration, 7);
    EXPECT_TRUE(first->input.images.equal(images));
    EXPECT_TRUE(first->input.shape.depth.equal(depth));
    EXPECT_TRUE(first->input.shape.position.equal(position));
    EXPECT_TRUE(first->input.shape.normal.equal(normal));
    EXPECT_TRUE(first->input.reference.equal(reference));
    const auto second = read_guidance_request(read);
    ASSERT_TRUE(second);
    EXPECT_TRUE(second->input.images.equal(images.slice(0, 0, 1).slice(3, 0, 8)));
    EXPECT_FALSE(second->input.shape.depth.defined());
    EXPECT_FALSE(read_guidance_request(read));
}

TEST(GuidanceStream, BrokenRequestsAreRefused) {
    EXPECT_NE(refusal("{\"iteration\"").find("ends within a line"), std::string::npos);
    EXPECT_NE(refusal(std::string(5000, ' ')).find("longer than"), std::string::npos);
    EXPECT_NE(refusal("[]\n").find("line is broken"), std::string::npos);
    EXPECT_NE(refusal(R"({"iteration": 0, "views": 0, "height": 8, "width": 8})"
                      "\n")
                  .find("line is broken"),
              std::string::npos);
    EXPECT_NE(refusal(small + ", \"surface\": true}\n").find("no depth"), std::string::npos);
    EXPECT_NE(refusal(R"({"iteration": 0, "views": 1024, "height": 4096, "width": 4096})"
                      "\n")
                  .find("1 GB"),
              std::string::npos);
    EXPECT_NE(refusal(small + "}\nabc").find("ends within images"), std::string::npos);
    EXPECT_NE(refusal(small + "}\n" + bytes_of(at::full({1, 3, 8, 8}, NAN))).find("not finite"),
              std::string::npos);
}

TEST(GuidanceStream, WritesALineAndTheGradient) {
    std::string written;
    const at::Tensor gradient = at::rand({1, 3, 8, 8});
    write_guidance_reply([&](const char* from, std::size_t size) { written.append(from, size); },
                         {{"iteration", 4}}, gradient);
    EXPECT_EQ(written, "{\"iteration\":4}\n" + bytes_of(gradient));
}

}  // namespace item3d
