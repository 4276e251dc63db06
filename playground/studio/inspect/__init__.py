"""Values under the mouse, histograms, legends."""
