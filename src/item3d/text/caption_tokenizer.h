// What the captioning networks ask of a tokenizer.
#pragma once

#include <string>
#include <vector>

namespace item3d {

class CaptionTokenizer {
  public:
    virtual ~CaptionTokenizer() = default;
    /// With the special tokens that the network's prompts begin and end with. text: UTF-8.
    virtual std::vector<int> encode(const std::string& text) const = 0;
    /// Special tokens are left out.
    virtual std::string decode(const std::vector<int>& ids) const = 0;
    virtual int largest_id() const = 0;
};

}  // namespace item3d
