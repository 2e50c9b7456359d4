// A plugin of clang-tidy that keeps its checks out of system headers, where nothing is reported anyway: most of the time would go there.
// lint_tidy.py compiles and loads it. clang's analyzer is not concerned: it follows the project's own files only.

#include <clang-tidy/ClangTidyCheck.h>
#include <clang-tidy/ClangTidyModule.h>
#include <clang-tidy/ClangTidyModuleRegistry.h>
#include <clang/AST/ASTContext.h>
#include <clang/ASTMatchers/ASTMatchFinder.h>
#include <clang/Basic/SourceManager.h>

#include <vector>

namespace {

// The translation unit is the first node that is visited, and its visitor asks for the scope after that (RecursiveASTVisitor.h).
class OwnCode : public clang::tidy::ClangTidyCheck {
  public:
    using ClangTidyCheck::ClangTidyCheck;

    void registerMatchers(clang::ast_matchers::MatchFinder* finder) override {
        finder->addMatcher(clang::ast_matchers::translationUnitDecl().bind("unit"), this);
    }

    void check(const clang::ast_matchers::MatchFinder::MatchResult& match) override {
        const clang::SourceManager& sources = *match.SourceManager;
        std::vector<clang::Decl*> own;
        for (clang::Decl* decl : match.Context->getTranslationUnitDecl()->decls()) {
            if (!sources.isInSystemHeader(sources.getExpansionLoc(decl->getLocation()))) own.push_back(decl);
        }
        match.Context->setTraversalScope(own);
    }
};

class OwnCodeModule : public clang::tidy::ClangTidyModule {
  public:
    void addCheckFactories(clang::tidy::ClangTidyCheckFactories& factories) override { factories.registerCheck<OwnCode>("antiskid-own-code"); }
};

const clang::tidy::ClangTidyModuleRegistry::Add<OwnCodeModule> registration("antiskid", "Checks of own code alone");

}  // namespace
