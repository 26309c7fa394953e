"""Actions of the repertoire, and the policies and judges that scripted teachers consult."""
