# SPDX-License-Identifier: BSD-3-Clause
# The jobs of a campaign, for snakemake; scripts/campaign calls it. The folder is the campaign's.
import sys

JOB = f"{sys.executable} {workflow.basedir}/campaign_job.py"
RUNS = list(config["runs"])


rule all:
    input:
        "index.html",


# A failed run is recorded in its figures, so that the table of the others is still written.
rule report:
    input:
        expand("figures/{run}.json", run=RUNS),
    output:
        "index.html", "campaign.csv", "timing.csv", "campaign.md",
    shell:
        JOB + " report"


def recording_of(wildcards):
    path = config["recordings"][wildcards.recording]["path"]
    return path or f"recordings/{wildcards.recording}/made_from"


rule run:
    input:
        ancient(recording_of),
    output:
        "figures/{recording}/{setting}.json",
    wildcard_constraints:
        recording="[^/]+", setting="[^/]+",
    threads: 1
    shell:
        JOB + " run {wildcards.recording} {wildcards.setting}"


rule simulate:
    output:
        "recordings/{recording}/made_from",
    wildcard_constraints:
        recording="[^/]+",
    threads: 1
    shell:
        JOB + " simulate {wildcards.recording}"
