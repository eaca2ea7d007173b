// The common parts of the checkers, which compare networks with recorded outputs of the reference
// libraries.
#pragma once

#include "item3d/core/config.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace item3d::parity {

/// Maximum errors at which tensors count as equal. They are relative to the maximum absolute
/// expected value, or to 1 if that is larger.
namespace within {
inline constexpr double one_pass = 2e-5;
inline constexpr double guidance_step = 5e-5;
inline constexpr double several_steps = 2e-4;
inline constexpr double image = 1e-3;
inline constexpr double scheduler_step = 1e-5;
inline constexpr double exact = 0.0;
}  // namespace within

/// A test case, which is a folder with recorded tensors in io.safetensors, and the report about it.
class Case {
  public:
    /// Throws InputError if io.safetensors is missing or unreadable.
    explicit Case(const std::filesystem::path& folder);

    const std::filesystem::path& folder() const { return folder_; }
    /// Reads meta.json. Throws InputError if it is missing.
    Config meta() const;
    bool has_meta() const;
    bool has(const std::string& tensor) const { return io_.contains(tensor); }
    /// Returns "in.NAME". Throws InputError if it is missing.
    at::Tensor input(const std::string& name) const;
    /// Returns the names of all recorded outputs, without "out.".
    std::vector<std::string> outputs() const;
    at::Tensor expected(const std::string& name) const;
    /// Returns NAME for each output whose name is PREFIX followed by NAME.
    std::vector<std::string> outputs_with_prefix(const std::string& prefix) const;

    void set_class(const std::string& name) { class_ = name; }
    /// Compares `actual` with "out.NAME". Reports the comparison as `reported_as`, or as `name` if
    /// that is empty. Does nothing if the case lacks the output.
    void compare(const std::string& name, const at::Tensor& actual, double tolerance,
                 const std::string& reported_as = "");
    /// Reports the relative L2 distance from `actual`, a bfloat16 output, to "out.NAME". The
    /// advised limit is twice the distance from "out.NAME" to the recorded float32 output,
    /// float32_name. Does not affect the result of the case.
    void orient(const std::string& name, const at::Tensor& actual, const std::string& float32_name);
    /// Records that `different` of `count` compared strings were different.
    void compare_texts(const std::string& name, std::int64_t count, std::int64_t different);
    /// Skips the outputs with this prefix and reports the reason.
    void skip(const std::string& prefix, const std::string& reason);

    /// True if something was compared and nothing exceeded its tolerance.
    bool passed() const;
    nlohmann::json report() const;

  private:
    std::filesystem::path folder_;
    SafeTensors io_;
    std::string class_;
    nlohmann::json results_ = nlohmann::json::array();
    nlohmann::json skipped_ = nlohmann::json::object();
    std::set<std::string> seen_;
    bool failed_ = false;
    bool compared_ = false;
};

/// Compares the images of meta.json after each image processor that it lists. Returns the outputs
/// of the processor in the case's own folder, [1, 3, h, w] each.
std::vector<at::Tensor> compare_image_processors(Case& golden);

void check_unet(Case& golden);
void check_autoencoder_kl(Case& golden);
void check_autoencoder_tiny(Case& golden);
void check_clip_text(Case& golden);
void check_clip_tokenizer(Case& golden);
void check_clip_vision(Case& golden);
void check_clip_model(Case& golden);
void check_clip_seg(Case& golden);
void check_blip(Case& golden);
void check_blip2(Case& golden);
void check_pipeline(Case& golden);
void check_schedulers(Case& golden);
void check_relative_direction(Case& golden);
void check_controlnet(Case& golden);
void check_lora(Case& golden);
void check_textual_inversion(Case& golden);

}  // namespace item3d::parity
