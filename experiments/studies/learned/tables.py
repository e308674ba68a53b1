"""The tables of the study of learned controllers, and the documents that show them.

Suites of other studies name some of these tables as well.
"""

from pathlib import Path

from experiments.studies.learned.blocks import BLOCKS, TABLE_BLOCKS
from experiments.tables.differences import difference_tables, paired_comparison_tables
from experiments.tables.document import Document
from experiments.tables.free_paths import free_path_tables
from experiments.tables.front import front_tables
from experiments.tables.gaps import gap_tables, near_optimum_tables
from experiments.tables.group_claims import group_claim_tables
from experiments.tables.headline import headline_tables

TABLES = {
    "headline": headline_tables,
    "gaps": gap_tables,
    "differences": difference_tables,
    "duels": paired_comparison_tables,
    "front": front_tables,
    "claims": group_claim_tables,
    "near-optimum": near_optimum_tables,
    "free-paths": free_path_tables,
}
DOCUMENTS = {
    "study": Document(Path("docs/study.md"), "study", "study", blocks=BLOCKS),
    "study-tables": Document(Path("docs/study-tables.md"), "study", "study-tables", blocks=TABLE_BLOCKS),
}
