// SPDX-License-Identifier: GPL-3.0-or-later
// YAML text to a tree, over yaml-cpp's events: its node API keeps duplicate keys silently, follows cycles and
// explodes on nested aliases; events show all of that before anything is built.
#include <yaml-cpp/anchor.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <optional>
#include <sstream>
#include <unordered_map>

#include "base/error.hpp"
#include "base/shown.hpp"
#include "base/yaml/value.hpp"

namespace millpose::yaml {
namespace {

constexpr size_t kMaxBytes = 4 << 20;
constexpr size_t kMaxValues = 500'000;  // 50 MB as a tree
constexpr size_t kMaxDepth = 32;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

bool IsContinuationByte(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

bool IsQuote(char c) { return c == '"' || c == '\''; }

// Behind the quoted text that begins at `from`; nothing where the line ends before it does.
std::optional<size_t> EndOfQuoted(std::string_view line, size_t from) {
  const char quote = line[from];
  for (size_t i = from + 1; i < line.size(); ++i) {
    const bool doubled = quote == '\'' && i + 1 < line.size() && line[i + 1] == quote;  // '' is one '
    if ((quote == '"' && line[i] == '\\') || (line[i] == quote && doubled))
      ++i;
    else if (line[i] == quote)
      return i + 1;
  }
  return std::nullopt;
}

// Whether a text may begin at `at`; within a word a quote is a character like others (5" pipe).
bool BeginsText(std::string_view line, size_t at) {
  const size_t before = line.find_last_not_of(' ', at == 0 ? std::string_view::npos : at - 1);
  if (at == 0 || before == std::string_view::npos) return true;
  if (line[before] == '[' || line[before] == '{' || line[before] == ',') return true;
  return before + 1 < at && (line[before] == ':' || line[before] == '-' || line[before] == '?');
}

// Where a quoted text begins that does not end in this line.
std::optional<size_t> OpenQuote(std::string_view line) {
  for (size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '#' && (i == 0 || line[i - 1] == ' ')) return std::nullopt;
    if (!IsQuote(line[i]) || !BeginsText(line, i)) continue;
    const auto end = EndOfQuoted(line, i);
    if (!end) return i;
    i = *end - 1;
  }
  return std::nullopt;
}

// Whether the lines below that are indented deeper are text as they stand (`text: |`, `text: >-`).
bool BeginsBlock(std::string_view line) {
  const size_t last = line.find_last_not_of("+-0123456789 ");
  return last != std::string_view::npos && last > 0 && (line[last] == '|' || line[last] == '>') &&
         line[last - 1] == ' ';
}

// Knows the text's lines, so that columns can be counted in characters where yaml-cpp counts bytes.
class Source {
 public:
  Source(std::string_view text, const std::string& name) : text_(text), name_(name) {
    lines_.push_back(text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);  // which has no column
    for (size_t i = 0; i < std::min(text.size(), kMaxBytes); ++i)
      if (text[i] == '\n') lines_.push_back(i + 1);
  }

  Mark At(const YAML::Mark& mark) const {
    if (mark.is_null()) return {};
    return InLine(mark.line, mark.column);
  }

  // A quoted text ends in its line: a quote that somebody forgot would end at the next one, many lines below.
  void RefuseOpenQuote(const YAML::Mark& mark) const {
    const std::string_view line = Line(static_cast<size_t>(mark.line));
    const auto column = static_cast<size_t>(mark.column);
    if (column < line.size() && IsQuote(line[column]) && !EndOfQuoted(line, column))
      FailOpenQuote(At(mark), line[column]);
  }

  // The same for a text that yaml-cpp gave up on in or before `last`: it tells where it stood, far below.
  void RefuseOpenQuotesUpTo(const YAML::Mark& last) const {
    std::optional<size_t> block_indent;
    for (size_t i = 0; i < lines_.size() && static_cast<int>(i) <= last.line; ++i) {
      const std::string_view line = Line(i);
      const size_t indent = line.find_first_not_of(' ');
      if (indent == std::string_view::npos || (block_indent && indent > *block_indent)) continue;
      block_indent = BeginsBlock(line) ? std::optional(indent) : std::nullopt;
      if (const auto column = OpenQuote(line))
        FailOpenQuote(InLine(static_cast<int>(i), static_cast<int>(*column)), line[*column]);
    }
  }

  [[noreturn]] void Fail(Mark mark, std::string message) const {
    throw InputError(SourceLocation{name_, mark.line, mark.column}, std::move(message));
  }

  // What yaml-cpp would take silently for something else: byte 4 ends its input, a tab counts as a blank.
  void RefuseOddCharacters() const {
    if (text_.size() > kMaxBytes)
      Fail(
          InLine(static_cast<int>(lines_.size()) - 1, static_cast<int>(kMaxBytes - lines_.back())),
          fmt::format("the file has {} bytes; allowed: at most {}, which end here", text_.size(), kMaxBytes));
    if (text_.starts_with("\xff\xfe") || text_.starts_with("\xfe\xff"))
      Fail({1, 1}, "the text is in UTF-16; allowed: UTF-8");
    for (size_t line = 0; line < lines_.size(); ++line) {
      const size_t end = line + 1 < lines_.size() ? lines_[line + 1] : text_.size();
      bool indentation = true;
      for (size_t i = lines_[line]; i < end; ++i) {
        const char c = text_[i];
        const auto mark = [&] { return InLine(static_cast<int>(line), static_cast<int>(i - lines_[line])); };
        if (c == '\t' && indentation) Fail(mark(), "given a tab in the indentation; allowed: blanks");
        if (c != ' ') indentation = false;
        const auto byte = static_cast<unsigned char>(c);
        if ((byte < 0x20 && c != '\t' && c != '\n' && c != '\r') || byte == 0x7f)
          Fail(mark(), fmt::format("given the control character 0x{:02x}; allowed: text in UTF-8", byte));
      }
    }
  }

 private:
  std::string_view Line(size_t line) const {
    if (line >= lines_.size()) return {};
    const size_t end = line + 1 < lines_.size() ? lines_[line + 1] - 1 : text_.size();
    const std::string_view found = text_.substr(lines_[line], end - lines_[line]);
    return found.ends_with('\r') ? found.substr(0, found.size() - 1) : found;
  }

  [[noreturn]] void FailOpenQuote(Mark mark, char quote) const {
    Fail(mark, fmt::format("{0} is opened here and not closed in this line; allowed: text with {0} at both "
                           "ends, in one line",
                           quote));
  }

  Mark InLine(int line, int byte) const {
    if (line < 0 || static_cast<size_t>(line) >= lines_.size()) return {line + 1, byte + 1};
    // A line may hold everything: what was counted for the place before is not counted again.
    if (line != counted_.line || byte < counted_.byte) counted_ = {line, 0, 0};
    const size_t from = lines_[line] + static_cast<size_t>(counted_.byte);
    const size_t end = std::min(lines_[line] + static_cast<size_t>(byte), text_.size());
    if (from < end)
      counted_.continuations +=
          static_cast<int>(std::ranges::count_if(text_.substr(from, end - from), IsContinuationByte));
    counted_.byte = byte;
    return {line + 1, byte + 1 - counted_.continuations};
  }

  struct Counted {
    int line = -1, byte = 0, continuations = 0;
  };

  std::string_view text_;
  const std::string& name_;
  std::vector<size_t> lines_;
  mutable Counted counted_;
};

class TreeBuilder : public YAML::EventHandler {
 public:
  explicit TreeBuilder(const Source& source) : source_(source) {}

  Value& root() { return root_; }
  int documents() const { return documents_; }
  /// The innermost list or map in brackets that has no end yet: where it begins, and how it would end.
  std::optional<std::pair<Mark, char>> OpenBracket() const {
    for (size_t i = open_.size(); i-- > 0;)
      if (in_brackets_[i]) return std::pair(open_[i]->mark, open_[i]->kind == Value::Kind::kMap ? '}' : ']');
    return std::nullopt;
  }
  const std::vector<std::pair<Mark, std::string>>& duplicates() const { return duplicates_; }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1)
      source_.Fail(source_.At(mark), "a second document starts here; allowed: one document a file");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    RefuseAnchor(mark, anchor);
    Value value;
    value.mark = source_.At(mark);
    Add(std::move(value), false);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t /*anchor*/) override {
    source_.Fail(source_.At(mark), "aliases (*name) are not allowed: write the value out");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& text) override {
    RefuseAnchor(mark, anchor);
    RefuseTag(mark, tag);
    source_.RefuseOpenQuote(mark);
    Value value = tag == "!" ? Value::Text(text) : Value::Plain(text);
    value.mark = source_.At(mark);
    Add(std::move(value), false);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override {
    Open(Value::List(), mark, tag, anchor);
    in_brackets_.back() = style == YAML::EmitterStyle::Flow;
  }
  void OnSequenceEnd() override { Close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override {
    Open(Value::Map(), mark, tag, anchor);
    in_brackets_.back() = style == YAML::EmitterStyle::Flow;
  }
  void OnMapEnd() override { Close(); }

 private:
  void RefuseAnchor(const YAML::Mark& mark, YAML::anchor_t anchor) const {
    if (anchor != 0) source_.Fail(source_.At(mark), "anchors (&name) are not allowed: write the value out");
  }
  void RefuseTag(const YAML::Mark& mark, const std::string& tag) const {
    if (tag.empty() || tag == "?" || tag == "!") return;
    source_.Fail(source_.At(mark),
                 fmt::format("given the tag {}; allowed: plain values without tags", Shown(tag)));
  }

  void Open(Value value, const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) {
    RefuseAnchor(mark, anchor);
    RefuseTag(mark, tag);
    value.mark = source_.At(mark);
    if (open_.size() >= kMaxDepth)
      source_.Fail(value.mark, fmt::format("nested deeper than {} levels", kMaxDepth));
    open_.push_back(&Add(std::move(value), true));
    key_lines_.emplace_back();
    in_brackets_.push_back(false);
  }
  void Close() {
    open_.pop_back();
    key_lines_.pop_back();
    in_brackets_.pop_back();
  }

  // Adds a node to what is open: in a map, keys and values come in turn. References into the innermost open
  // node stay valid because only that node grows.
  Value& Add(Value value, bool is_container) {
    if (++values_ > kMaxValues)
      source_.Fail(value.mark,
                   fmt::format("more than {} keys and values; allowed: at most as many", kMaxValues));
    if (open_.empty()) return root_ = std::move(value);
    Value& parent = *open_.back();
    if (parent.kind == Value::Kind::kMap && parent.keys.size() == parent.items.size()) {
      if (is_container || value.kind != Value::Kind::kScalar)
        source_.Fail(value.mark, "given a key that is no word; allowed: a name followed by a colon");
      if (value.text == "<<" && value.plain)
        source_.Fail(value.mark, "merge keys (<<) are not allowed: write the keys out");
      AddKey(parent, value);
      return parent;
    }
    // yaml-cpp places a missing value at whatever follows; its key is where a reader looks.
    if (value.kind == Value::Kind::kNull && parent.kind == Value::Kind::kMap)
      value.mark = parent.keys.back().mark;
    parent.items.push_back(std::move(value));
    return parent.items.back();
  }

  void AddKey(Value& parent, const Value& key) {
    const auto [first, is_new] = key_lines_.back().emplace(key.text, key.mark.line);
    if (!is_new && duplicates_.size() <= kMostProblems)
      duplicates_.emplace_back(
          key.mark, fmt::format("{}: given twice; the first is in line {}", Shown(key.text), first->second));
    parent.keys.push_back({key.text, key.mark});
  }

  const Source& source_;
  Value root_;
  std::vector<Value*> open_;
  std::vector<std::unordered_map<std::string, int>> key_lines_;  ///< of what is open, if a map
  std::vector<bool> in_brackets_;                                ///< of what is open
  std::vector<std::pair<Mark, std::string>> duplicates_;
  int documents_ = 0;
  size_t values_ = 0;
};

// In words of our own where yaml-cpp has only "end of sequence flow not found", which nobody can act upon.
[[noreturn]] void FailUnreadable(const Source& source, const TreeBuilder& builder,
                                 const YAML::Exception& error) {
  source.RefuseOpenQuotesUpTo(error.mark);
  const Mark found = source.At(error.mark);
  const bool unclosed =
      error.msg == YAML::ErrorMsg::END_OF_SEQ_FLOW || error.msg == YAML::ErrorMsg::END_OF_MAP_FLOW;
  const auto open = builder.OpenBracket();
  if (unclosed && open)
    source.Fail(
        open->first,
        fmt::format("not YAML: {} is opened here and not closed; {} or a comma is missing before line "
                    "{}, column {}",
                    open->second == ']' ? '[' : '{', open->second, found.line, found.column));
  if (error.msg == YAML::ErrorMsg::FLOW_END)
    source.Fail(found, "not YAML: this bracket is not the end of the one that is open here");
  if (error.msg == YAML::ErrorMsg::MAP_VALUE)
    source.Fail(
        found,
        "not YAML: no key may stand before this colon; is one missing at the end of the line above, or "
        "are quotes missing round a text with a colon?");
  source.Fail(found, "not YAML: " + error.msg);
}

}  // namespace

Value ReadYaml(std::string_view text, const std::string& name) {
  const Source source(text, name);
  source.RefuseOddCharacters();
  TreeBuilder builder(source);
  std::istringstream stream{std::string(text)};
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    FailUnreadable(source, builder, error);
  }
  std::vector<Problem> problems;
  for (const auto& [mark, message] : builder.duplicates())
    problems.push_back({{name, mark.line, mark.column}, message});
  if (!problems.empty()) throw InputError(std::move(problems));
  return std::move(builder.root());
}

}  // namespace millpose::yaml
