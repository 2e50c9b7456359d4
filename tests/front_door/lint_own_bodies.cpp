// A plugin of clang that leaves out the bodies of functions in system headers: more than half of the time of a file that is only checked would go
// there. Bodies that the language needs, of constexpr functions and those whose result is deduced, are parsed nevertheless.
// lint_alone.py compiles and loads it.

#include <clang/AST/ASTConsumer.h>
#include <clang/AST/Decl.h>
#include <clang/Basic/SourceManager.h>
#include <clang/Frontend/CompilerInstance.h>
#include <clang/Frontend/FrontendPluginRegistry.h>

#include <memory>
#include <string>
#include <vector>

namespace {

class OwnBodies : public clang::ASTConsumer {
  public:
    explicit OwnBodies(const clang::SourceManager& sources) : sources_(sources) {}
    bool shouldSkipFunctionBody(clang::Decl* function) override {
        return sources_.isInSystemHeader(sources_.getExpansionLoc(function->getLocation()));
    }

  private:
    const clang::SourceManager& sources_;
};

class OwnBodiesAction : public clang::PluginASTAction {
  protected:
    std::unique_ptr<clang::ASTConsumer> CreateASTConsumer(clang::CompilerInstance& compiler, llvm::StringRef) override {
        compiler.getFrontendOpts().SkipFunctionBodies = true;  // is read after this, and asks every consumer
        return std::make_unique<OwnBodies>(compiler.getSourceManager());
    }
    bool ParseArgs(const clang::CompilerInstance&, const std::vector<std::string>&) override { return true; }
    ActionType getActionType() override { return AddBeforeMainAction; }
};

const clang::FrontendPluginRegistry::Add<OwnBodiesAction> registration("antiskid-own-bodies", "Bodies of the project's own functions alone");

}  // namespace
