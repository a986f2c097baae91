"""The rule of import-linter that a module with an underscore is private to its folder."""

import grimp
from importlinter import Contract, ContractCheck, output


class PrivateModulesContract(Contract):
    """A module of the name `_x` is imported only from its own folder and the folders in it; other rooms ask the folder.

    The package itself may, since it loads its names lazily.
    """

    def check(self, graph: grimp.ImportGraph, verbose: bool) -> ContractCheck:
        """Find the imports that break the rule."""
        del verbose
        broken = sorted(
            f"{importer} -> {module}"
            for module in graph.modules
            if "." in module and _is_private(module)
            for importer in graph.find_modules_that_directly_import(module)
            if not _may_import(importer, module)
        )
        return ContractCheck(kept=not broken, metadata={"broken": broken})

    def render_broken_contract(self, check: ContractCheck) -> None:
        """Print the imports that break the rule."""
        for line in check.metadata["broken"]:
            output.print_error(line)


def _is_private(module: str) -> bool:
    return module.rpartition(".")[2].startswith("_")


def _may_import(importer: str, module: str) -> bool:
    folder = module.rpartition(".")[0]
    return importer == "nonholo" or importer == folder or importer.startswith(f"{folder}.")
